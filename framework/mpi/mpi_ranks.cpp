// libpelorus-mpi.so: the ranks of a campaign by MPI. A library of its own, so that MPI is needed by those alone who use it.
#include <boost/mpi/communicator.hpp>
#include <boost/mpi/environment.hpp>
#include <boost/mpi/exception.hpp>
#include <boost/mpi/status.hpp>

#include <limits>

#include "campaign/rank_library.hpp"
#include "host/error.hpp"

namespace pelorus::campaign {

namespace {

namespace mpi = boost::mpi;

constexpr int tag = 1;

class MpiRanks final : public Ranks {
public:
    // The environment ends MPI when it goes, and all ranks with it when an exception is under way.
    MpiRanks() : environment_(mpi::threading::funneled) {}

    int rank() const override { return world_.rank(); }
    int size() const override { return world_.size(); }

    void send(int to, const Bytes& bytes) override {
        if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
            throw Error(Exit::run_failed, "a block of runs has more than 2 GB of results");
        world_.send(to, tag, bytes.data(), static_cast<int>(bytes.size()));
    }

    std::optional<std::pair<int, Bytes>> poll() override {
        const boost::optional<mpi::status> waiting = world_.iprobe(mpi::any_source, tag);
        if (!waiting) return std::nullopt;
        Bytes bytes(static_cast<std::size_t>(waiting->count<unsigned char>().value()));
        world_.recv(waiting->source(), tag, bytes.data(), static_cast<int>(bytes.size()));
        return std::make_pair(waiting->source(), std::move(bytes));
    }

private:
    mpi::environment environment_;
    mpi::communicator world_;
};

}  // namespace

}  // namespace pelorus::campaign

extern "C" __attribute__((visibility("default"))) pelorus::campaign::Ranks* pelorus_open_ranks_1() {
    try {
        return new pelorus::campaign::MpiRanks();
    } catch (const std::exception& problem) {
        throw pelorus::Error(pelorus::Exit::run_failed, std::string("MPI does not start: ") + problem.what());
    }
}
