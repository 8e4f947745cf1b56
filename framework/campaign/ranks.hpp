/// Processes of one campaign, as MPI starts them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pelorus::campaign {

/// One of several processes. All calls come from the thread that opened it.
class Ranks {
public:
    using Bytes = std::vector<unsigned char>;

    virtual ~Ranks() = default;
    virtual int rank() const = 0;
    virtual int size() const = 0;
    virtual void send(int to, const Bytes& bytes) = 0;
    /// A message that has come, and from whom; nothing if there is none.
    virtual std::optional<std::pair<int, Bytes>> poll() = 0;
};

/// Whether an MPI launcher has started this process as one of several.
bool is_started_by_mpi();

/// Which one this process is, as the launcher has told it; 0 without a launcher.
int launched_rank();

/// The processes that the launcher has started. MPI is loaded now, from libpelorus-mpi.so beside libpelorus.so: without a launcher
/// it is never needed. Throws Error: it is not there, or does not go.
std::unique_ptr<Ranks> open_ranks();

}  // namespace pelorus::campaign
