/// analyzer.plane_motion: is a target moving in a plane? See README.md.
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pelorus/stage.hpp>

#include "plane_fit.hpp"
#include "points.hpp"

namespace plane_motion {

enum class Statistic { errors_in_variables, regression };
enum class Window { fixed, growing, sliding };

struct WindowRow {
    double start = 0, end = 0;  // s
};

class PlaneAnalyzer : public pelorus::Stage<PlaneAnalyzer> {
public:
    static constexpr const char* kind = "analyzer";
    enum OutPort : std::uint32_t { results_out, plane_out };

    static void describe(pelorus::Describe<PlaneAnalyzer>& plugin);
    void setup(const pelorus::Setup& setup);
    std::vector<pelorus::Stream> in_streams(std::uint32_t) const { return points_.streams(); }

    void on_scan(const pelorus::Event& event, const plr_scan& scan);
    void finish(const pelorus::Event& event);

    template <class Archive> void state(Archive& archive) {
        archive(samples_, verdicts_, fresh_, latest_, points_.caller());
        for (const auto& [when, verdict] : verdicts_)
            if (verdict.status >= status_count) throw pelorus::DataError("a saved test has no status that is known");
    }

private:
    /// A test that was done.
    struct Verdict {
        std::int64_t start = 0, end = 0, first = 0;  // ns
        std::uint64_t samples = 0;
        std::uint32_t status = 0;  // Status
        double statistic = 0, critical = 0, degrees = 0;
        Vector<3> normal = Vector<3>::Zero();
        double offset = 0;
        bool is_rejected() const noexcept { return statistic > critical; }
        template <class Archive> void state(Archive& archive) {
            archive(start, end, first, samples, status, statistic, critical, degrees, normal, offset);
        }
    };

    static void describe_windows(pelorus::Describe<PlaneAnalyzer>& plugin);
    void check_parameters() const;
    void keep(const Sample& sample);
    void forget();
    void test_fixed(std::int64_t now);
    void test_newest();
    void test(std::int64_t start, std::int64_t end, bool is_open);
    double critical(int degrees, double level);
    void tell_plane(const Verdict& verdict);
    void add_scalars(pelorus::ResultBuilder& table) const;
    const Verdict* verdict_at(std::int64_t limit) const;

    Statistic statistic_ = Statistic::errors_in_variables;
    Window window_ = Window::fixed;
    std::vector<WindowRow> windows_;
    std::optional<double> from_, length_;            // s
    std::optional<std::vector<double>> scalars_at_;  // s
    double level_ = 0.05;
    std::int64_t every_ = 1, capacity_ = 1000;

    Points points_;
    std::map<std::pair<int, double>, double> quantiles_;  ///< of chi-square, by degrees of freedom and level

    // state
    std::deque<Sample> samples_;                                         ///< in the order of their times
    std::map<std::pair<std::int64_t, std::int64_t>, Verdict> verdicts_;  ///< by end and start (ns)
    std::int64_t fresh_ = 0;                                             ///< samples since the last test
    std::int64_t latest_ = std::numeric_limits<std::int64_t>::min();     ///< ns, of the newest sample
};

}  // namespace plane_motion
