// The zoo's extent: a sphere whose size nothing changes, with a misdeed.
#include "zoo.hpp"

namespace {

using Shape = pelorus::Matrix<3>;

struct ZooExtent : pelorus::Extent<ZooExtent> {
    using Base = pelorus::Extent<ZooExtent>;
    static constexpr double radius = 10;  // m
    zoo::Fault fault = zoo::Fault::none;
    std::string in;

    static void describe(pelorus::Describe<ZooExtent>& plugin) {
        plugin.title("An extent of the zoo");
        zoo::describe(plugin);
    }
    void setup(const pelorus::Setup&) {
        info.dimension = 3;
        info.start_scans = 1;
        info.start_points = 1;
        info.record_version = 1;
        info.record_size = 1;
    }

    static Shape shape_of(const plr_const_view& record, std::int64_t i) {
        const double size = record.data[i * record.item_stride];
        return size * size * Shape::Identity();
    }
    static void copy(const plr_const_view& from, const plr_view& to, std::int64_t i) {
        to.data[i * to.item_stride] = from.data[i * from.item_stride];
    }

    plr_status init(const plr_call& call, const plr_extent_init& args) const {
        return pelorus::for_items(call, args.record.count,
                                  [&](std::int64_t i) { args.record.data[i * args.record.item_stride] = radius; });
    }
    plr_status predict(const plr_call& call, const plr_extent_predict& args) const {
        return pelorus::for_items(call, args.out.count, [&](std::int64_t i) { copy(args.record, args.out, i); });
    }
    plr_status effective_noise(const plr_call& call, const plr_extent_effective_noise& args) const {
        return pelorus::for_items(call, args.out.count, [&](std::int64_t i) {
            const double number = args.number.data[i * args.number.item_stride];
            pelorus::store<3, 3>(args.out, i, (shape_of(args.record, i) + pelorus::load<3, 3>(args.noise, i)) / number);
        });
    }
    plr_status update(const plr_call& call, const plr_extent_update& args) const {
        return pelorus::for_items(call, args.out.count, [&](std::int64_t i) {
            copy(args.record, args.out, i);
            if (args.log_likelihood.data != nullptr) args.log_likelihood.data[i * args.log_likelihood.item_stride] = 0;
        });
    }
    plr_status shape(const plr_call& call, const plr_extent_shape& args) const {
        return pelorus::for_items(call, args.matrix.count, [&](std::int64_t i) {
            pelorus::store<3, 3>(args.matrix, i, shape_of(args.record, i));
            if (args.half_axes.data != nullptr)
                pelorus::store<3, 1>(args.half_axes, i, pelorus::Vector<3>::Constant(radius));
            if (args.axes.data != nullptr) pelorus::store<3, 3>(args.axes, i, Shape::Identity());
        });
    }
    plr_status gate(const plr_call& call, const plr_extent_gate& args) const {
        return pelorus::for_items(call, args.predicted.count, [&](std::int64_t i) {
            for (std::int64_t k = args.scan.offsets[i]; k < args.scan.offsets[i + 1]; ++k)
                args.squared_distance.data[k * args.squared_distance.item_stride] = 0;
        });
    }

    static const ZooExtent& of(const void* self) { return *static_cast<const ZooExtent*>(self); }
    static plr_status init_entry(const void* self, const plr_call* call, const plr_extent_init* args) {
        return zoo::act(of(self), "init", call, args->scan->points, args->record,
                        [&] { return Base::table().init(self, call, args); });
    }
    static plr_status predict_entry(const void* self, const plr_call* call, const plr_extent_predict* args) {
        return zoo::act(of(self), "predict", call, args->before, args->out,
                        [&] { return Base::table().predict(self, call, args); });
    }
    static plr_status noise_entry(const void* self, const plr_call* call, const plr_extent_effective_noise* args) {
        return zoo::act(of(self), "effective_noise", call, args->noise, args->out,
                        [&] { return Base::table().effective_noise(self, call, args); });
    }
    static plr_status update_entry(const void* self, const plr_call* call, const plr_extent_update* args) {
        return zoo::act(of(self), "update", call, args->scan.points, args->out,
                        [&] { return Base::table().update(self, call, args); });
    }
    static plr_status shape_entry(const void* self, const plr_call* call, const plr_extent_shape* args) {
        return zoo::act(of(self), "shape", call, args->record, args->matrix,
                        [&] { return Base::table().shape(self, call, args); });
    }
    static plr_status gate_entry(const void* self, const plr_call* call, const plr_extent_gate* args) {
        return zoo::act(of(self), "gate", call, args->scan.points, args->squared_distance,
                        [&] { return Base::table().gate(self, call, args); });
    }
    static const plr_extent& table() {
        static const plr_extent zoo = [] {
            plr_extent t = Base::table();
            t.head.destroy = &zoo::destroy<ZooExtent>;
            t.init = &init_entry;
            t.predict = &predict_entry;
            t.effective_noise = &noise_entry;
            t.update = &update_entry;
            t.shape = &shape_entry;
            t.gate = &gate_entry;
            return t;
        }();
        return zoo;
    }
};

}  // namespace

ZOO_PLUGIN(ZooExtent, "org.example.extent.zoo");
