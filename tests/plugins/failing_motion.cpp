// A motion that fails in each step as its parameter says: what does a run tell of it?
#include <stdexcept>

#include <pelorus/pelorus.hpp>

namespace {

enum class Failure { exception, numeric };

struct FailingMotion : pelorus::KroneckerMotion<FailingMotion, 2, 3> {
    static void describe(pelorus::Describe<FailingMotion>& plugin) {
        plugin.title("A motion that fails");
        plugin.parameter("failure", &FailingMotion::failure)
            .initially("exception")
            .choices(
                {{"exception", "an exception that nobody expects"}, {"numeric", "a result that cannot be computed"}})
            .doc("what happens in each step");
    }
    std::vector<double> priors() const { return {1e6, 100.0}; }
    Block transition(double) const {
        if (failure == Failure::exception) throw std::runtime_error("boom");
        throw pelorus::NumericError("no such root");
    }
    Block noise_block(double) const { return Block::Identity(); }

    Failure failure = Failure::exception;
};

}  // namespace

PELORUS_PLUGIN(FailingMotion, "org.example.motion.failing");
