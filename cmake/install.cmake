# What `cmake --install` puts where: the Debian package is that, and tests/process/package_install_test.sh lists it.
include(GNUInstallDirs)
set(MARCHD_UNIT_DIR lib/systemd/system CACHE STRING "where the system's units go")

# The daemon and march look for the worker beside themselves.
install(TARGETS marchd march march-launch RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
# What a node needs is a component, and a package, of its own.
install(TARGETS march-worker RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT worker)
# So is what browsers need: a farm may do without.
install(TARGETS march-web RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT web)

# The Python client is a component, and a package, of its own.
set(MARCHD_PYTHON_DIR lib/python3/dist-packages CACHE STRING "where Python finds modules")
install(DIRECTORY python/marchd DESTINATION ${MARCHD_PYTHON_DIR} COMPONENT python FILES_MATCHING PATTERN *.py PATTERN py.typed
        PATTERN __pycache__ EXCLUDE PATTERN .mypy_cache EXCLUDE)

# Units name the programs where they are installed. The system's are installed again as a template: marchd@NAME is a farm
# of its own, beside the first.
function(install_units folder destination)
    foreach(unit ${ARGN})
        set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${folder}/${unit})
        file(READ ${folder}/${unit} text)
        string(REGEX REPLACE "(ExecStart|ExecReload)=/usr/bin/" "\\1=${CMAKE_INSTALL_FULL_BINDIR}/" text "${text}")
        file(WRITE ${PROJECT_BINARY_DIR}/${folder}/${unit} "${text}")
        install(FILES ${PROJECT_BINARY_DIR}/${folder}/${unit} DESTINATION ${destination} ${unit_component})
    endforeach()
endfunction()
function(install_template unit)
    string(REPLACE "." "@." template ${unit})
    file(READ ${PROJECT_BINARY_DIR}/deploy/${unit} text)
    string(REPLACE "/marchd --system " "/marchd --system --config /etc/marchd/%i.conf --state /var/lib/%N --socket /run/marchd/%N.sock "
        text "${text}")
    string(REPLACE "/march-launch\n" "/march-launch --config /etc/marchd/%i.conf\n" text "${text}")
    string(REGEX REPLACE "(Wants=|After=%N.socket )march-launch.socket" "\\1march-launch@%i.socket" text "${text}")
    string(REPLACE "/march-launch.sock\n" "/march-launch@%i.sock\n" text "${text}")
    string(REGEX REPLACE "(PartOf|Before)=marchd.service" "\\1=marchd@%i.service" text "${text}")
    string(REGEX REPLACE "-(/[a-z/]*/marchd) " "-\\1 -\\1@%i " text "${text}")
    file(WRITE ${PROJECT_BINARY_DIR}/deploy/${template} "${text}")
    install(FILES ${PROJECT_BINARY_DIR}/deploy/${template} DESTINATION ${MARCHD_UNIT_DIR})
endfunction()
set(units marchd.service marchd.socket march-launch.service march-launch.socket)
install_units(deploy ${MARCHD_UNIT_DIR} ${units})
foreach(unit ${units})
    install_template(${unit})
endforeach()
install_units(deploy/user lib/systemd/user ${units})
set(unit_component COMPONENT web)
install_units(deploy ${MARCHD_UNIT_DIR} march-web.service)
install(FILES deploy/march-web.sysusers DESTINATION lib/sysusers.d RENAME marchd-web.conf COMPONENT web)
install(FILES deploy/march-web.conf DESTINATION /etc/marchd COMPONENT web)
install(FILES jobs/schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/marchd COMPONENT web)
install(DIRECTORY web/page DESTINATION ${CMAKE_INSTALL_DATADIR}/marchd COMPONENT web)
install(FILES deploy/marchd.sysusers DESTINATION lib/sysusers.d RENAME marchd.conf)
install(FILES deploy/marchd.tmpfiles DESTINATION lib/tmpfiles.d RENAME marchd.conf)
# The daemon reads it there, whatever the prefix.
install(FILES deploy/marchd.conf DESTINATION /etc/marchd)
install(FILES deploy/ssh_config DESTINATION /etc/marchd/ssh RENAME config)

foreach(section 1 5 8)
    file(GLOB pages CONFIGURE_DEPENDS deploy/man/*.${section})
    list(FILTER pages EXCLUDE REGEX "march-worker|march-web")
    install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man${section})
endforeach()
install(FILES deploy/man/march-worker.8 DESTINATION ${CMAKE_INSTALL_MANDIR}/man8 COMPONENT worker)
install(FILES deploy/man/march-web.8 DESTINATION ${CMAKE_INSTALL_MANDIR}/man8 COMPONENT web)
install(FILES deploy/man/march-web.conf.5 DESTINATION ${CMAKE_INSTALL_MANDIR}/man5 COMPONENT web)
install(FILES README.md STYLE.md CONTRIBUTING.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/marchd)
install(DIRECTORY deploy/prometheus deploy/grafana DESTINATION ${CMAKE_INSTALL_DATADIR}/marchd)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/marchd)
# Without the programs that drew and simulated what is there.
install(DIRECTORY jobs DESTINATION ${CMAKE_INSTALL_DATADIR}/marchd
        PATTERN smoke/simulate EXCLUDE PATTERN cumulus/grow EXCLUDE PATTERN textures/draw_* EXCLUDE)
