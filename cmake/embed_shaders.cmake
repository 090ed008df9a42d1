# Turns every shaders/**/*.glsl into a C table of name and text: embed_shaders(OUTPUT_C).
function(embed_shaders output)
    file(GLOB_RECURSE modules CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/shaders
         ${PROJECT_SOURCE_DIR}/shaders/*.glsl ${PROJECT_SOURCE_DIR}/shaders/*.vert ${PROJECT_SOURCE_DIR}/shaders/*.frag)
    set(paths ${modules})
    list(TRANSFORM paths PREPEND ${PROJECT_SOURCE_DIR}/shaders/)
    add_custom_command(OUTPUT ${output}
        COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} -DROOT=${PROJECT_SOURCE_DIR}/shaders "-DMODULES=${modules}"
                -P ${PROJECT_SOURCE_DIR}/cmake/embed_shaders_script.cmake
        DEPENDS ${paths} ${PROJECT_SOURCE_DIR}/cmake/embed_shaders_script.cmake VERBATIM)
endfunction()
