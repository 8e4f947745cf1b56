// scheduler.bench_echo: answers each scan with the same command, over whose feedback edge it comes back to the source.
#include <limits>

#include <pelorus/pelorus.hpp>

namespace {

struct Echo : pelorus::Stage<Echo> {
    static constexpr const char* kind = "scheduler";

    pelorus::Vector<1> number = pelorus::Vector<1>::Zero();
    plr_quantity quantity{};
    plr_values values{};

    static void describe(pelorus::Describe<Echo>& plugin) {
        plugin.title("A command for each scan")
            .purpose("Publishes one number for each scan, for measuring the runtime.");
        plugin.in_port("scans", PLR_MESSAGE_SCAN, "what is answered");
        plugin.out_port("commands", PLR_MESSAGE_VALUES, "`number`, addressed to `ticks`");
    }

    void setup(const pelorus::Setup&) {
        quantity.struct_size = sizeof quantity;
        quantity.address = "ticks";
        quantity.name = "number";
        quantity.unit = "";
        quantity.numbers = pelorus::const_view(number.data(), 1, 1, 1);
        quantity.valid_to = std::numeric_limits<std::int64_t>::max();
        values = {sizeof values, 1, &quantity};
    }
    void on_scan(const pelorus::Event& event, const plr_scan&) {
        plr_message message = pelorus::detail::message_of(PLR_MESSAGE_VALUES, event.time);
        message.body.values = &values;
        publish(0, message);
    }
};

}  // namespace

PELORUS_PLUGIN(Echo, "scheduler.bench_echo");
