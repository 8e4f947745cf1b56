/// A plugin project made from the templates that come with the command.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pelorus::cli {

struct Project {
    std::string kind;              ///< `motion`
    std::string name;              ///< `drag`: of the library, the source file and the folder
    std::filesystem::path folder;  ///< is made
};

/// `org.example.motion.drag`
std::string plugin_id(const Project& project);

/// Why a plugin project cannot have this name, or "".
std::string name_problem(const std::string& name);

/// The folder of the running executable, symbolic links resolved. Throws Error (Exit::run_failed).
std::filesystem::path executable_folder();

/// Fills in the kind's templates and answers the names of the files made. On failure nothing is left behind. Throws Error: the
/// folder is there already or cannot be made (Exit::misuse), there are no templates (Exit::run_failed).
std::vector<std::string> make_project(const Project& project);

}  // namespace pelorus::cli
