# A program is its folder's library and main.c, so that tests link the same objects.
function(add_folder_program name library)
    add_executable(${name} main.c)
    target_link_libraries(${name} PRIVATE ${library} commit)
endfunction()
