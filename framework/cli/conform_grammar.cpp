#include "cli/conform_grammar.hpp"

#include "cli/config_flags.hpp"

namespace pelorus::cli {

const Grammar& conform_grammar() {
    static const Grammar grammar = [] {
        Grammar all;
        all.arguments = {"LIB.so"};
        all.flags = {
            {"list", "", "all checks with the laws they try, and no library"},
            {"kind", "KIND", "plugins of this kind alone", true},
            {"only", "NAME", "this check and those that it rests on, whatever their level", true},
            {"level", "1..5",
             "1: it loads; 2: the contract; 3 (the default): the laws of its kind; 4: statistics "
             "and fuzz; 5: load and cost"},
            {"seed", "N", "of the random samples (1)"},
            {"subjects", "FILE",
             "what is tried, in YAML: titles, each with `use`, `with` and `parts` as in a "
             "config; else the defaults and each single choice"},
            {"names", "", "only tell the names of the checks that would be made, a line each"},
            {"json", "FILE", "write the report as JSON (`-`: to standard output)"},
            {"junit", "FILE", "write it as JUnit XML"},
            {"from", "FILE", "try nothing: tell what a report (--json) of the library says, of --only if given"},
            {"quiet", "", "tell what failed, and the sum, alone"},
            {"jobs", "N", "checks at once; as many as the machine has cores unless given"},
            {"time-limit", "S", "seconds of processor time that a check may take (20)"},
            plugins_flag()};
        all.without_arguments = "list";
        return all;
    }();
    return grammar;
}

}  // namespace pelorus::cli
