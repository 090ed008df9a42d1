# The object library `commit` holds the commit that is built. Programs alone link it: another commit compiles one small file.
set(commit_source ${PROJECT_BINARY_DIR}/commit.c)
add_custom_target(find_commit BYPRODUCTS ${commit_source} VERBATIM COMMENT "Looking up the commit"
    COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} -DOUTPUT=${commit_source}
            -P ${PROJECT_SOURCE_DIR}/cmake/commit_script.cmake)
add_library(commit OBJECT ${commit_source})
add_dependencies(commit find_commit)
