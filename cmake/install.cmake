# What `cmake --install` puts where; the Debian package is that, and tests/process/package_install_test.sh lists it.
include(GNUInstallDirs)
set(MARCHD_UNIT_DIR ${CMAKE_INSTALL_PREFIX}/lib/systemd CACHE PATH "where systemd's units go: system/ and user/ below it")
set(MARCHD_DOC_DIR ${CMAKE_INSTALL_DATADIR}/doc/marchd)

# The daemon and march look for the worker beside themselves.
install(TARGETS marchd march march-worker RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})

install(DIRECTORY jobs/ DESTINATION ${CMAKE_INSTALL_DATADIR}/marchd/jobs
        PATTERN smoke/convert EXCLUDE PATTERN textures/draw_* EXCLUDE)
install(FILES README.md STYLE.md DESTINATION ${MARCHD_DOC_DIR})
install(DIRECTORY docs DESTINATION ${MARCHD_DOC_DIR})

file(GLOB pages_1 CONFIGURE_DEPENDS deploy/man/*.1)
file(GLOB pages_5 CONFIGURE_DEPENDS deploy/man/*.5)
file(GLOB pages_8 CONFIGURE_DEPENDS deploy/man/*.8)
foreach(section 1 5 8)
    install(FILES ${pages_${section}} DESTINATION ${CMAKE_INSTALL_MANDIR}/man${section})
endforeach()

install(FILES deploy/marchd.service deploy/marchd.socket DESTINATION ${MARCHD_UNIT_DIR}/system)
install(FILES deploy/user/marchd.service deploy/user/marchd.socket DESTINATION ${CMAKE_INSTALL_PREFIX}/lib/systemd/user)
install(FILES deploy/marchd.sysusers DESTINATION lib/sysusers.d RENAME marchd.conf)
install(FILES deploy/marchd.tmpfiles DESTINATION lib/tmpfiles.d RENAME marchd.conf)
install(FILES deploy/marchd.conf DESTINATION ${CMAKE_INSTALL_FULL_SYSCONFDIR}/marchd)
