# An inline function or template that a kernel file defines as a weak symbol may be the copy the linker keeps for the
# whole program: AVX instructions would then run on a processor without them. Fails when a kernel defines one.
#   cmake -D NM=nm -D OBJECTS=a.o;b.o -P check_kernel_symbols.cmake
list(FILTER OBJECTS INCLUDE REGEX "/simd/[^/]*_avx(2|512)\\.cpp\\.o$")
if(NOT OBJECTS)
  message(FATAL_ERROR "there is no kernel among the objects")
endif()
foreach(object IN LISTS OBJECTS)
  execute_process(COMMAND ${NM} --defined-only --demangle ${object} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "[0-9a-f]+ [WVu] [^\n]*" weak "${symbols}")
  if(weak)
    string(REPLACE ";" "\n  " weak "${weak}")
    message(SEND_ERROR "${object} defines weak symbols:\n  ${weak}")
  endif()
endforeach()
