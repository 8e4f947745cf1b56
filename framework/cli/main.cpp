#include "cli/command.hpp"
#include "cli/crash.hpp"
#include "cli/output.hpp"

int main(int argc, char** argv) {
    pelorus::cli::prepare_streams();
    pelorus::cli::tell_crashes();
    return pelorus::cli::run_command_line({argv + 1, argv + argc});
}
