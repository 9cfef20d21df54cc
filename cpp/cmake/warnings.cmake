# Flags of our own targets, as interface targets:
#   pdoik_warnings  what we want to be warned of
#   pdoik_sanitize  what PDOIK_SANITIZE asks for
#   pdoik_native    what PDOIK_NATIVE asks for, or else pdoik_eigen_abi; linked by all that is compiled here
#   pdoik_eigen_abi how the library has Eigen align and allocate; installed as pdoik::eigen_abi
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

# The library has Eigen align to 16 bytes and take its memory from plain malloc, whatever flags it is compiled with: so do
# PCL, which Debian compiles without AVX, and programs that are. Eigen objects cross to both (pdoik/abi.hpp).
add_library(pdoik_eigen_abi INTERFACE)
add_library(pdoik::eigen_abi ALIAS pdoik_eigen_abi)
set_target_properties(pdoik_eigen_abi PROPERTIES EXPORT_NAME eigen_abi)
target_compile_definitions(pdoik_eigen_abi INTERFACE EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MALLOC_ALREADY_ALIGNED=1)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  # With AVX those two alone are not enough: products of large matrices copy to blocks from malloc and read these as if
  # they were aligned to 32 bytes. Hence no AVX in what has Eigen in it.
  set(no_avx -mno-avx)
endif()
target_compile_options(pdoik_eigen_abi INTERFACE ${no_avx})

add_library(pdoik_native INTERFACE)
if(PDOIK_NATIVE)
  # AVX all the same, in the library and its tests only: no matrix here comes near the size at which blocks leave the
  # stack (128 kB). In Debug Eigen's own checks would object.
  target_compile_definitions(pdoik_native INTERFACE EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MALLOC_ALREADY_ALIGNED=1)
  target_compile_options(pdoik_native INTERFACE $<$<NOT:$<CONFIG:Debug>>:-march=native>)
else()
  target_link_libraries(pdoik_native INTERFACE pdoik_eigen_abi)
endif()
