# One set of warnings, sanitizers and definitions for every target of the project.
add_compile_definitions(_GNU_SOURCE MARCHD_VERSION="${PROJECT_VERSION}")
add_compile_options(-Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wvla -Wundef
                    -Wpointer-arith -Wwrite-strings -Wformat=2 -Wno-unused-parameter -Wno-overlength-strings)
include_directories(${PROJECT_SOURCE_DIR})
# What a library's own CMake file adds is linked only where it is used: OpenEXR's of Debian 13 adds Imath.
add_link_options(-Wl,--as-needed)

if(MARCHD_WERROR)
    add_compile_options(-Werror)
endif()
if(MARCHD_SANITIZE)
    add_compile_options(-fsanitize=${MARCHD_SANITIZE} -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
    add_link_options(-fsanitize=${MARCHD_SANITIZE})
endif()
if(MARCHD_COVERAGE)
    add_compile_options(--coverage)
    add_link_options(--coverage)
endif()
