# What the command says of itself, as files that editors, man and bash find: made by the command, so that they cannot differ
# from it. They lie in the build tree as in an installation.

# They, and the reference of the plugins, speak of what is shipped: a second `pelorus` beside which lie the folders of the kinds
# alone, and none of the examples that the build tree's own one finds as well.
set(shipped "${PROJECT_BINARY_DIR}/shipped")
set(PELORUS_SHIPPED_EXECUTABLE "${shipped}/bin/pelorus")
get_property(shipped_plugins GLOBAL PROPERTY PELORUS_PLUGINS)
file(GLOB kinds RELATIVE "${PROJECT_SOURCE_DIR}/plugins" CONFIGURE_DEPENDS plugins/*)
list(FILTER kinds EXCLUDE REGEX "^common$|\\.")
set(link_kinds "")
foreach(kind IN LISTS kinds)
    list(APPEND link_kinds COMMAND "${CMAKE_COMMAND}" -E create_symlink "../../../lib/pelorus/${kind}" "${shipped}/lib/pelorus/${kind}")
endforeach()
set(stamp "${shipped}.made")
add_custom_command(OUTPUT "${stamp}"
                   COMMAND "${CMAKE_COMMAND}" -E rm -rf "${shipped}"
                   COMMAND "${CMAKE_COMMAND}" -E make_directory "${shipped}/bin" "${shipped}/lib/pelorus"
                   COMMAND "${CMAKE_COMMAND}" -E create_hardlink $<TARGET_FILE:pelorus_framework> "${shipped}/lib/libpelorus.so"
                   ${link_kinds}
                   COMMAND "${CMAKE_COMMAND}" -E create_hardlink $<TARGET_FILE:pelorus> "${PELORUS_SHIPPED_EXECUTABLE}"
                   COMMAND "${CMAKE_COMMAND}" -E touch "${stamp}"
                   DEPENDS pelorus pelorus_framework VERBATIM)
add_custom_target(shipped_command DEPENDS "${stamp}")

set(schema "${PROJECT_BINARY_DIR}/share/pelorus/config.schema.json")
set(manual "${PROJECT_BINARY_DIR}/share/man/man1/pelorus.1")
set(completion "${PROJECT_BINARY_DIR}/share/bash-completion/completions/pelorus")
file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/share/pelorus" "${PROJECT_BINARY_DIR}/share/man/man1"
                    "${PROJECT_BINARY_DIR}/share/bash-completion/completions")

set(command "${CMAKE_COMMAND}" -E env --unset=PELORUS_PLUGIN_PATH "${PELORUS_SHIPPED_EXECUTABLE}")
add_custom_command(OUTPUT "${schema}" COMMAND ${command} schema --out "${schema}"
                   DEPENDS shipped_command "${stamp}" ${shipped_plugins} COMMENT "Writing the schema of configs" VERBATIM)
add_custom_command(OUTPUT "${manual}" "${completion}"
                   COMMAND ${command} help --man > "${manual}"
                   COMMAND ${command} completion bash > "${completion}"
                   DEPENDS shipped_command "${stamp}" COMMENT "Writing the manual page and the completion" VERBATIM)
add_custom_target(command_files ALL DEPENDS "${schema}" "${manual}" "${completion}")

install(FILES "${schema}" DESTINATION share/pelorus COMPONENT host)
install(FILES "${manual}" DESTINATION share/man/man1 COMPONENT host)
install(FILES "${completion}" DESTINATION share/bash-completion/completions COMPONENT host)
