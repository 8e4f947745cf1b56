/// analyzer.identity: tracks against known identities. See README.md.
#pragma once

#include <pelorus/stage.hpp>

#include "tally.hpp"

namespace analyzer_identity {

class IdentityAnalyzer : public pelorus::Stage<IdentityAnalyzer> {
public:
    static constexpr const char* kind = "analyzer";
    static constexpr std::uint32_t state_version = 2;
    static void describe(pelorus::Describe<IdentityAnalyzer>& plugin);

    void on_truth(const pelorus::Event& event, const plr_truth& message);
    void on_tracks(const pelorus::Event& event, const plr_tracks& message);
    void finish(const pelorus::Event& event);

    template <class Archive> void state(Archive& archive) { archive(tally_); }

private:
    void publish_identities(std::int64_t time);
    void publish_tracks(std::int64_t time);

    double patience_ = 600;  // s
    Tally tally_;
};

}  // namespace analyzer_identity
