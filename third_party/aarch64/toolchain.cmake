# Debian's cross compiler for aarch64, and qemu to run what it makes:
#   cmake -D CMAKE_TOOLCHAIN_FILE=third_party/aarch64/toolchain.cmake [-D CMAKE_SYSROOT=build/aarch64/root] ...
# Without a root it has the C and C++ libraries that come with the compiler, which is enough for pdoik::core.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(triple aarch64-linux-gnu)
set(CMAKE_LIBRARY_ARCHITECTURE ${triple})
set(CMAKE_CXX_COMPILER ${triple}-g++)
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CMAKE_SYSROOT)

if(CMAKE_SYSROOT)
  set(emulated_root ${CMAKE_SYSROOT})
else()
  set(emulated_root /usr/${triple})
endif()
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static;-L;${emulated_root})

# Programs are those of this machine; what is compiled against comes from the root alone, where there is one.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
if(CMAKE_SYSROOT)
  set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
  set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
  set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
endif()
