#include "campaign/ranks.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>

#include <boost/dll/runtime_symbol_info.hpp>

#include "campaign/rank_library.hpp"
#include "host/error.hpp"

namespace pelorus::campaign {

namespace {

bool is_several(const char* variable) {
    const char* const size = std::getenv(variable);
    return size != nullptr && std::atoi(size) > 1;
}

}  // namespace

bool is_started_by_mpi() {
    // Open MPI's launcher, MPICH's and its kin, and Slurm's own with PMIx. A process alone needs no MPI.
    return is_several("OMPI_COMM_WORLD_SIZE") || is_several("PMI_SIZE") ||
           (std::getenv("PMIX_RANK") != nullptr && is_several("SLURM_NTASKS"));
}

int launched_rank() {
    if (!is_started_by_mpi()) return 0;
    for (const char* variable : {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"})
        if (const char* const rank = std::getenv(variable)) return std::atoi(rank);
    return 0;
}

std::unique_ptr<Ranks> open_ranks() {
    const std::filesystem::path own = boost::dll::this_line_location().string();
    const std::filesystem::path library = own.parent_path() / rank_library_name;
    // MPI libraries load parts of their own that need their symbols.
    void* const handle = ::dlopen(library.c_str(), RTLD_NOW | RTLD_GLOBAL);
    const char* const reason = handle == nullptr ? ::dlerror() : nullptr;
    void* const symbol = handle == nullptr ? nullptr : ::dlsym(handle, rank_library_function);
    if (symbol == nullptr)
        throw Error(Exit::run_failed, "started by an MPI launcher, but MPI cannot be used: " +
                                          std::string(reason != nullptr ? reason : "it is another version") +
                                          "; run without the launcher, with --threads");
    const auto open = reinterpret_cast<OpenRanks*>(symbol);
    return std::unique_ptr<Ranks>(open());
}

}  // namespace pelorus::campaign
