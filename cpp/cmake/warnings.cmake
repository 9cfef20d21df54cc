# Flags of our own targets, as interface targets:
#   pdoik_warnings  what we want to be warned of
#   pdoik_sanitize  what PDOIK_SANITIZE asks for
#   pdoik_native    what PDOIK_NATIVE asks for; linked by all that includes the private headers
# The library links them as $<BUILD_INTERFACE:...>: a user of the installed library gets none of them.
add_library(pdoik_warnings INTERFACE)
target_compile_options(pdoik_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion $<$<BOOL:${PDOIK_WERROR}>:-Werror>
  -Wno-psabi)  # how wide vectors are passed matters between libraries only, and none is passed there

add_library(pdoik_sanitize INTERFACE)
if(PDOIK_SANITIZE)
  target_compile_options(pdoik_sanitize INTERFACE
    -fsanitize=${PDOIK_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(pdoik_sanitize INTERFACE -fsanitize=${PDOIK_SANITIZE})
endif()

add_library(pdoik_native INTERFACE)
if(PDOIK_NATIVE)
  # Eigen objects cross to PCL and to users compiled without AVX, so Eigen must align and allocate as it does there:
  # to 16 bytes, with plain malloc. Eigen's own check of that in Debug would object.
  set(optimised $<NOT:$<CONFIG:Debug>>)
  target_compile_options(pdoik_native INTERFACE $<${optimised}:-march=native>)
  target_compile_definitions(pdoik_native INTERFACE
    $<${optimised}:EIGEN_MAX_ALIGN_BYTES=16> $<${optimised}:EIGEN_MALLOC_ALREADY_ALIGNED=1>)
endif()
