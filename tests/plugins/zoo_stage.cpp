// The zoo's stage: counts scans, with a misdeed.
#include "zoo.hpp"

namespace {

struct ZooStage : pelorus::Stage<ZooStage> {
    using Base = pelorus::Stage<ZooStage>;
    static constexpr const char* kind = "analyzer";
    zoo::Fault fault = zoo::Fault::none;
    std::string in;
    std::int64_t scans = 0;

    static void describe(pelorus::Describe<ZooStage>& plugin) {
        plugin.title("A stage of the zoo");
        plugin.in_port("scans", PLR_MESSAGE_SCAN, "what is counted");
        zoo::describe(plugin);
    }
    std::vector<pelorus::Stream> in_streams(std::uint32_t) const {
        pelorus::Stream stream;
        stream.any_sensor = stream.any_frame = stream.any_space = true;
        return {stream};
    }
    void on_scan(const pelorus::Event&, const plr_scan&) { ++scans; }
    template <class Archive> void state(Archive& archive) { archive(scans); }

    static const ZooStage& of(const void* self) { return *static_cast<const ZooStage*>(self); }
    static plr_status port_type(const void* self, std::uint32_t is_output, std::uint32_t port, plr_port_type* out,
                                plr_error* error) {
        if (of(self).in == "port_type") zoo::misbehave(of(self).fault);
        return Base::table().port_type(self, is_output, port, out, error);
    }
    static plr_status receive(void* self, const plr_call* call, std::uint32_t port, const plr_message* message) {
        double unused[3] = {};
        const plr_view nothing{unused + 1, 1, 1, 1, 1, 1, 1};
        return zoo::act(of(self), "receive", call, message->body.scan->measurements, nothing,
                        [&] { return Base::table().receive(self, call, port, message); });
    }
    static plr_status finish(void* self, const plr_call* call) {
        if (of(self).in == "finish") zoo::misbehave(of(self).fault);
        return Base::table().finish(self, call);
    }
    static const plr_stage& table() {
        static const plr_stage zoo = [] {
            plr_stage t = Base::table();
            t.head.destroy = &zoo::destroy<ZooStage>;
            t.port_type = &ZooStage::port_type;
            t.receive = &ZooStage::receive;
            t.finish = &ZooStage::finish;
            return t;
        }();
        return zoo;
    }
};

}  // namespace

ZOO_PLUGIN(ZooStage, "org.example.analyzer.zoo");
