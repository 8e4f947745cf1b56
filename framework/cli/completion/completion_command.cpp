// `pelorus completion`: what a shell needs to complete command lines.
#include "cli/command.hpp"
#include "cli/output.hpp"
#include "host/error.hpp"

namespace pelorus::cli {

namespace {

/// Asks the command itself, so that it always fits the version that is called.
const char* const bash_script = R"(# Completion of pelorus for bash; printed by `pelorus completion bash`.

_pelorus()
{
    local word=${COMP_WORDS[COMP_CWORD]} line
    [[ $word == = ]] && word=
    local files=()
    COMPREPLY=()
    while IFS= read -r line; do
        case $line in
            :folders) mapfile -t -O "${#files[@]}" files < <(compgen -d -- "$word") ;;
            :files) mapfile -t -O "${#files[@]}" files < <(compgen -f -- "$word") ;;
            :files\ *)
                mapfile -t -O "${#files[@]}" files < <(compgen -f -X "!*${line#:files }" -- "$word")
                mapfile -t -O "${#files[@]}" files < <(compgen -d -- "$word")
                ;;
            *=) COMPREPLY+=("$line"); compopt -o nospace 2>/dev/null ;;
            *) COMPREPLY+=("$line") ;;
        esac
    done < <("${COMP_WORDS[0]}" complete "$COMP_CWORD" "${COMP_WORDS[@]}" 2>/dev/null)
    ((${#files[@]})) || return 0
    compopt -o filenames 2>/dev/null
    mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(printf '%s\n' "${files[@]}" | sort -u)
}
complete -F _pelorus pelorus
)";

int completion(const CommandLine& line) {
    if (line.argument(0) != "bash")
        throw Error(Exit::misuse, "completion: expected bash, got '" + line.argument(0) + "'");
    print(bash_script);
    return static_cast<int>(Exit::done);
}

}  // namespace

Command completion_command() {
    return {"completion",
            "completion of command lines, for a shell",
            "Prints a script that teaches bash to complete commands, flags, kinds, ids of plugins, files, and the "
            "addresses "
            "of a config after --set. An installed Pelorus has it in share/bash-completion/completions, where bash "
            "finds it "
            "by itself.",
            {{"SHELL"}, {}, {}},
            {{"source <(pelorus completion bash)", "for this shell"},
             {"mkdir -p ~/.local/share/bash-completion/completions", "for all to come: the folder, if it is not there"},
             {"pelorus completion bash > ~/.local/share/bash-completion/completions/pelorus", "and the script in it"}},
            &completion};
}

}  // namespace pelorus::cli
