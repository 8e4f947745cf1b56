/// What a track of an extended target is made of: an estimator with an extent beside it, or a joint extent. Both behind one
/// interface, so that the tracker's life cycle does not know which.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pelorus/small_matrix.hpp>
#include <pelorus/stage.hpp>

#include "points.hpp"

namespace extended {

/// All state of a target at one time.
struct Records {
    std::vector<double> kinematics;  ///< the estimator's; empty with a joint extent
    std::vector<double> extent;
    template <class Archive> void state(Archive& archive) { archive(kinematics, extent); }
};

struct Moments {
    Eigen::VectorXd mean;        ///< c
    Eigen::MatrixXd covariance;  ///< c x c
};

/// What the centroid of a scan was to a filter.
struct Update {
    double log_likelihood = 0;
    double squared_innovation = 0;  ///< e' S^-1 e, in Cartesian components
};

/// e' S^-1 e. Throws NumericError where S is not positive definite.
inline double squared_innovation(const Eigen::VectorXd& innovation, const Eigen::MatrixXd& covariance) {
    using Square = pelorus::small::Bounded<3, 3>;
    const Square given = covariance;
    Square root(given.rows(), given.cols());
    if (!pelorus::small::cholesky(given, root))
        throw pelorus::NumericError("the innovation covariance is not positive definite");
    return pelorus::small::inverse_quadratic(root, pelorus::small::Bounded<3, 1>(innovation));
}

/// Who is asked for, and when.
struct Look {
    std::int64_t time = 0;
    std::uint64_t id = 0;
    plr_key key{};
};

class TargetFilter {
public:
    virtual ~TargetFilter() = default;
    const pelorus::Space& space() const noexcept { return space_; }
    int dimension() const noexcept { return extent_.info().dimension; }
    const plr_extent_info& extent_info() const noexcept { return extent_.info(); }
    const std::vector<SensorOfPoints>& sensors() const noexcept { return sensors_; }
    /// The points of a scan by the sensor that made it. `refused` counts measurements that could not be converted. Throws DataError
    /// for a scan of another sensor, and for one whose measurements have times of their own.
    Points points_of(pelorus::Caller& caller, std::int64_t time, const plr_scan& scan, std::int64_t& refused) const {
        std::size_t index = 0;
        while (index < sensors_.size() && sensors_[index].part().name() != scan.sensor) ++index;
        if (index == sensors_.size())
            throw pelorus::DataError("there is no sensor " + std::string(scan.sensor) + " in the slot `sensors`");
        if (scan.times != nullptr)
            for (std::int64_t k = 0; k < scan.measurements.count; ++k)
                if (scan.times[k] != time)
                    throw pelorus::DataError(
                        "measurements of one scan have times of their own; this tracker takes them as of one time");
        Points points = sensors_[index].convert(caller, time, scan, refused);
        points.sensor = index;
        return points;
    }
    std::uint32_t record_version() const noexcept { return version_; }
    std::size_t kinematics_size() const noexcept { return kinematics_size_; }
    std::size_t extent_size() const noexcept { return extent_size_; }
    /// 0, 1, 2 for position, velocity, acceleration; -1 for anything else.
    int derivative(int component) const noexcept { return derivative_[static_cast<std::size_t>(component)]; }
    int axis(int component) const noexcept { return axis_[static_cast<std::size_t>(component)]; }

    /// Starts from one scan, the components of which `known` tells with their moments.
    virtual Records start(pelorus::Caller& caller, const Look& look, const std::vector<const Points*>& scans,
                          const Moments& moments) const = 0;
    /// Starts from two scans by differencing; the uncertainty is what the shape implies.
    virtual Records start_differenced(pelorus::Caller& caller, const Look& look,
                                      const std::vector<const Points*>& scans, const Eigen::VectorXd& mean) const = 0;
    virtual void predict(pelorus::Caller& caller, const Look& look, double dt, Records& records) const = 0;
    virtual Update update(pelorus::Caller& caller, const Look& look, const Points& points, Records& records) const = 0;
    virtual Moments summary(pelorus::Caller& caller, const Look& look, const Records& records) const = 0;
    /// Squared statistical distance of each point.
    virtual std::vector<double> distances(pelorus::Caller& caller, const Look& look, const Points& points,
                                          const Records& records) const = 0;

    virtual Eigen::MatrixXd shape(pelorus::Caller& caller, const Look& look, const Records& records) const {
        Eigen::MatrixXd matrix(dimension(), dimension());
        auto args = pelorus::arguments<plr_extent_shape>();
        args.record = input(records.extent);
        args.matrix = pelorus::view(matrix);
        caller.require(extent_.call(&plr_extent::shape, begin(caller, look), args), "extent, shape");
        return matrix;
    }

protected:
    explicit TargetFilter(const pelorus::ExtentPart& extent)
        : extent_(extent), extent_size_(static_cast<std::size_t>(extent.info().record_size)) {}

    /// Takes over what another filter has found out about the space and the sensors.
    void take_space(const TargetFilter& other) {
        space_ = other.space_;
        sensors_ = other.sensors_;
        derivative_ = other.derivative_;
        axis_ = other.axis_;
    }

    /// Takes over the Cartesian space of the kinematics. Throws PartError where its positions are not the extent's axes.
    void describe(const plr_space& cartesian, const plr_part* sensors, std::uint32_t count, const std::string& slot) {
        space_ = pelorus::Space(cartesian);
        static const char* const derivatives[] = {"position", "velocity", "acceleration"};
        static const char* const axes[] = {".x", ".y", ".z"};
        int positions = 0;
        for (int c = 0; c < space_.size(); ++c) {
            derivative_.push_back(-1);
            axis_.push_back(-1);
            for (int k = 0; k < 3; ++k)
                for (int a = 0; a < 3; ++a)
                    if (space_[c].name == std::string(derivatives[k]) + axes[a]) {
                        derivative_.back() = k;
                        axis_.back() = a;
                    }
            positions += derivative_.back() == 0;
            if (c < dimension() && (derivative_.back() != 0 || axis_.back() != c))
                throw pelorus::PartError(slot, "the kinematics begin with " + space_.text() + "; an extent of " +
                                                   std::to_string(dimension()) +
                                                   " dimensions wants as many positions first");
        }
        if (positions != dimension())
            throw pelorus::PartError("extent", "has " + std::to_string(dimension()) +
                                                   " dimensions, the kinematics have " + std::to_string(positions) +
                                                   " axes");
        const char* at = reinterpret_cast<const char*>(sensors);
        for (std::uint32_t i = 0; i < count; ++i) {
            const auto& part = *reinterpret_cast<const plr_part*>(at);
            sensors_.emplace_back(part, dimension(), slot);
            at += part.struct_size;
        }
        if (sensors_.empty())
            throw pelorus::PartError(slot, "has no sensors; fill its slot `sensors` with those of the scans");
    }

    static const plr_call& begin(pelorus::Caller& caller, const Look& look) {
        return caller.begin(look.time, 1, &look.id, &look.key);
    }
    static plr_const_view input(const std::vector<double>& record) {
        return pelorus::const_view(record.data(), static_cast<std::int64_t>(record.size()), 1, 1);
    }
    static plr_view output(std::vector<double>& record) {
        return pelorus::view(record.data(), static_cast<std::int64_t>(record.size()), 1, 1);
    }

    /// Scans and their times (s, since the first) as an extent's start wants them.
    struct StartScans {
        explicit StartScans(const std::vector<const Points*>& scans) {
            for (const Points* scan : scans) {
                views.push_back(std::make_unique<PointsView>(*scan));
                raw.push_back(views.back()->c());
                times.push_back(static_cast<double>(scan->time - scans.front()->time) * 1e-9);
            }
        }
        plr_const_view time_view() const {
            return pelorus::const_view(times.data(), static_cast<std::int64_t>(times.size()), 1, 1);
        }
        std::vector<std::unique_ptr<PointsView>> views;
        std::vector<plr_extent_points> raw;
        std::vector<double> times;
    };

    pelorus::ExtentPart extent_;
    pelorus::Space space_;
    std::vector<SensorOfPoints> sensors_;
    std::vector<int> derivative_, axis_;
    std::uint32_t version_ = 0;
    std::size_t kinematics_size_ = 0, extent_size_ = 0;
};

}  // namespace extended
