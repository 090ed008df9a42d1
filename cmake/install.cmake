# What `cmake --install` puts where: the Debian package is that, and tests/process/package_install_test.sh lists it.
include(GNUInstallDirs)
set(MARCHD_UNIT_DIR lib/systemd/system CACHE STRING "where the system's units go")

# The daemon and march look for the worker beside themselves.
install(TARGETS marchd march march-worker RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})

# Units name the programs where they are installed. The system's are installed again as a template: marchd@NAME is a farm
# of its own, beside the first.
function(install_units folder destination)
    foreach(unit marchd.service marchd.socket)
        set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${folder}/${unit})
        file(READ ${folder}/${unit} text)
        string(REGEX REPLACE "(ExecStart|ExecReload)=/usr/bin/" "\\1=${CMAKE_INSTALL_FULL_BINDIR}/" text "${text}")
        file(WRITE ${PROJECT_BINARY_DIR}/${folder}/${unit} "${text}")
        install(FILES ${PROJECT_BINARY_DIR}/${folder}/${unit} DESTINATION ${destination})
    endforeach()
endfunction()
function(install_template unit)
    file(READ ${PROJECT_BINARY_DIR}/deploy/marchd.${unit} text)
    string(REPLACE "/marchd --system\n"
        "/marchd --system --config /etc/marchd/%i.conf --state /var/lib/%N --socket /run/marchd/%N.sock\n" text "${text}")
    file(WRITE ${PROJECT_BINARY_DIR}/deploy/marchd@.${unit} "${text}")
    install(FILES ${PROJECT_BINARY_DIR}/deploy/marchd@.${unit} DESTINATION ${MARCHD_UNIT_DIR})
endfunction()
install_units(deploy ${MARCHD_UNIT_DIR})
install_template(service)
install_template(socket)
install_units(deploy/user lib/systemd/user)
install(FILES deploy/marchd.sysusers DESTINATION lib/sysusers.d RENAME marchd.conf)
install(FILES deploy/marchd.tmpfiles DESTINATION lib/tmpfiles.d RENAME marchd.conf)
# The daemon reads it there, whatever the prefix.
install(FILES deploy/marchd.conf DESTINATION /etc/marchd)

foreach(section 1 5 8)
    file(GLOB pages CONFIGURE_DEPENDS deploy/man/*.${section})
    install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man${section})
endforeach()
install(FILES README.md STYLE.md CONTRIBUTING.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/marchd)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/marchd)
# Without the programs that drew and simulated what is there.
install(DIRECTORY jobs DESTINATION ${CMAKE_INSTALL_DATADIR}/marchd
        PATTERN smoke/simulate EXCLUDE PATTERN textures/draw_* EXCLUDE)
