# pdoik_warnings: the warnings our own targets are compiled with.
# pdoik_sanitize: what PDOIK_SANITIZE asks for; nothing when that is empty.
# Both are linked as $<BUILD_INTERFACE:...>, so that a user of the installed library gets neither.
add_library(pdoik_warnings INTERFACE)
target_compile_options(pdoik_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion $<$<BOOL:${PDOIK_WERROR}>:-Werror>)

add_library(pdoik_sanitize INTERFACE)
if(PDOIK_SANITIZE)
  target_compile_options(pdoik_sanitize INTERFACE
    -fsanitize=${PDOIK_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(pdoik_sanitize INTERFACE -fsanitize=${PDOIK_SANITIZE})
endif()
