# What the command says of itself, as files that editors, man and bash find: made by the command, so that they cannot differ
# from it. They lie in the build tree as in an installation.

set(schema "${PROJECT_BINARY_DIR}/share/pelorus/config.schema.json")
set(manual "${PROJECT_BINARY_DIR}/share/man/man1/pelorus.1")
set(completion "${PROJECT_BINARY_DIR}/share/bash-completion/completions/pelorus")
get_property(shipped_plugins GLOBAL PROPERTY PELORUS_PLUGINS)
file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/share/pelorus" "${PROJECT_BINARY_DIR}/share/man/man1"
                    "${PROJECT_BINARY_DIR}/share/bash-completion/completions")

set(command "${CMAKE_COMMAND}" -E env --unset=PELORUS_PLUGIN_PATH $<TARGET_FILE:pelorus>)
add_custom_command(OUTPUT "${schema}" COMMAND ${command} schema --out "${schema}"
                   DEPENDS pelorus ${shipped_plugins} COMMENT "Writing the schema of configs" VERBATIM)
add_custom_command(OUTPUT "${manual}" "${completion}"
                   COMMAND ${command} help --man > "${manual}"
                   COMMAND ${command} completion bash > "${completion}"
                   DEPENDS pelorus COMMENT "Writing the manual page and the completion" VERBATIM)
add_custom_target(command_files ALL DEPENDS "${schema}" "${manual}" "${completion}")

install(FILES "${schema}" DESTINATION share/pelorus COMPONENT host)
install(FILES "${manual}" DESTINATION share/man/man1 COMPONENT host)
install(FILES "${completion}" DESTINATION share/bash-completion/completions COMPONENT host)
