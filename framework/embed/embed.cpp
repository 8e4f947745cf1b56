// Everything that is done with an open pipeline.
#include <limits>

#include "embed/boundary.hpp"
#include "embed/handles.hpp"

namespace {

using namespace pelorus::embed;

constexpr std::size_t usual_capacity = 1024;

/// A call on a pipeline, by one thread at a time.
template <class Work> plr_status on(pelorus_pipeline* pipeline, plr_error* error, Work work) noexcept {
    return call(error, [&] {
        require(pipeline, "pipeline");
        const Occupied occupied(pipeline->busy);
        work(pipeline->own);
    });
}

template <class Work> plr_status on(pelorus_subscription* subscription, plr_error* error, Work work) noexcept {
    return call(error, [&] {
        require(subscription, "subscription");
        const Occupied occupied(subscription->pipeline->busy);
        work(*subscription->queue);
    });
}

template <class Entries> const auto& entry(const Entries& entries, std::uint32_t index, const char* what) {
    if (index >= entries.size())
        throw Failure(PELORUS_E_NOT_FOUND, "there is no " + std::string(what) + " " + std::to_string(index) +
                                               "; there are " + std::to_string(entries.size()));
    return entries[index];
}

}  // namespace

extern "C" {

plr_status pelorus_node(pelorus_pipeline* pipeline, uint32_t index, pelorus_node_info* out, plr_error* error) {
    return on(pipeline, error, [&](Pipeline& own) { answer(out, entry(own.nodes(), index, "node"), "out"); });
}

plr_status pelorus_port(pelorus_pipeline* pipeline, uint32_t index, pelorus_port_info* out, plr_error* error) {
    return on(pipeline, error, [&](Pipeline& own) { answer(out, entry(own.ports(), index, "port"), "out"); });
}

plr_status pelorus_push(pelorus_pipeline* pipeline, const char* port, const plr_message* message, plr_error* error) {
    return on(pipeline, error, [&](Pipeline& own) {
        require(port, "port");
        require(message, "message");
        own.push(port, *message);
    });
}

plr_status pelorus_advance(pelorus_pipeline* pipeline, int64_t until, plr_error* error) {
    return on(pipeline, error, [&](Pipeline& own) { own.advance(until); });
}

plr_status pelorus_play(pelorus_pipeline* pipeline, plr_error* error) {
    return on(pipeline, error, [](Pipeline& own) { own.play(); });
}

void pelorus_stop(pelorus_pipeline* pipeline) {
    if (pipeline != nullptr) pipeline->own.stop();
}

plr_status pelorus_finish(pelorus_pipeline* pipeline, plr_error* error) {
    return on(pipeline, error, [](Pipeline& own) { own.finish(); });
}

plr_status pelorus_now(pelorus_pipeline* pipeline, int64_t* out, plr_error* error) {
    return on(pipeline, error, [&](Pipeline& own) {
        require(out, "out");
        *out = own.now().value_or(std::numeric_limits<std::int64_t>::min());
    });
}

plr_status pelorus_subscribe(pelorus_pipeline* pipeline, const char* port, const pelorus_subscription_options* options,
                             pelorus_subscription** out, plr_error* error) {
    if (out != nullptr) *out = nullptr;
    return on(pipeline, error, [&](Pipeline& own) {
        require(port, "port");
        require(out, "out");
        const pelorus_subscription_options wanted = given(options, "options");
        if (wanted.when_full > PELORUS_WHEN_FULL_DROP_OLDEST)
            refuse("options.when_full is " + std::to_string(wanted.when_full) +
                   ", expected one of PELORUS_WHEN_FULL_... (0 or 1)");
        auto made = std::make_unique<pelorus_subscription>();
        made->pipeline = pipeline;
        made->queue = &own.subscribe(port, wanted.capacity == 0 ? usual_capacity : wanted.capacity,
                                     wanted.when_full == PELORUS_WHEN_FULL_DROP_OLDEST);
        *out = made.get();
        pipeline->subscriptions.emplace(made.get(), std::move(made));
    });
}

plr_status pelorus_pull(pelorus_subscription* subscription, const plr_message** out, plr_error* error) {
    if (out != nullptr) *out = nullptr;
    return on(subscription, error, [&](Subscription& queue) {
        require(out, "out");
        *out = queue.pull();
    });
}

plr_status pelorus_subscription_state(pelorus_subscription* subscription, pelorus_subscription_info* out,
                                      plr_error* error) {
    return on(subscription, error, [&](Subscription& queue) {
        answer(out, {sizeof(pelorus_subscription_info), 0, queue.waiting(), queue.dropped()}, "out");
    });
}

void pelorus_unsubscribe(pelorus_subscription* subscription) {
    if (subscription == nullptr) return;
    pelorus_pipeline* const pipeline = subscription->pipeline;
    on(pipeline, nullptr, [&](Pipeline& own) {
        own.unsubscribe(*subscription->queue);
        pipeline->subscriptions.erase(subscription);
    });
}

plr_status pelorus_scalar(pelorus_pipeline* pipeline, uint32_t index, pelorus_scalar_info* out, plr_error* error) {
    return on(pipeline, error,
              [&](Pipeline& own) { answer(out, entry(own.results().scalars(), index, "scalar"), "out"); });
}

plr_status pelorus_find_scalar(pelorus_pipeline* pipeline, const char* name, pelorus_scalar_info* out,
                               plr_error* error) {
    return on(pipeline, error, [&](Pipeline& own) {
        require(name, "name");
        for (const pelorus_scalar_info& scalar : own.results().scalars())
            if (std::strcmp(scalar.name, name) == 0) return answer(out, scalar, "out");
        throw Failure(PELORUS_E_NOT_FOUND, "there is no scalar '" + std::string(name) + "' so far");
    });
}

plr_status pelorus_table(pelorus_pipeline* pipeline, uint32_t index, const plr_table** out, plr_error* error) {
    if (out != nullptr) *out = nullptr;
    return on(pipeline, error, [&](Pipeline& own) {
        require(out, "out");
        *out = &entry(own.results().tables(), index, "table");
    });
}

plr_status pelorus_diagnostic(pelorus_pipeline* pipeline, uint32_t index, pelorus_diagnostic_info* out,
                              plr_error* error) {
    return on(pipeline, error,
              [&](Pipeline& own) { answer(out, entry(own.results().diagnostics(), index, "diagnostic"), "out"); });
}

plr_status pelorus_snapshot(pelorus_pipeline* pipeline, const plr_writer* writer, plr_error* error) {
    return on(pipeline, error, [&](Pipeline& own) {
        require(writer, "writer");
        const plr_writer to = given(writer, "writer");
        if (to.write == nullptr) refuse("writer.write is NULL");
        const std::vector<unsigned char> bytes = own.snapshot();
        plr_error from_writer{};
        from_writer.struct_size = sizeof from_writer;
        const plr_status status = to.write(to.context, bytes.data(), bytes.size(), &from_writer);
        if (status == PLR_OK) return;
        from_writer.message[sizeof from_writer.message - 1] = '\0';
        throw Failure(status, *from_writer.message ? from_writer.message : "the writer refused the snapshot");
    });
}

plr_status pelorus_restore(pelorus_pipeline* pipeline, const void* bytes, uint64_t size, plr_error* error) {
    return on(pipeline, error, [&](Pipeline& own) {
        require(bytes, "bytes");
        const auto* first = static_cast<const unsigned char*>(bytes);
        own.restore({first, first + size});
    });
}

}  // extern "C"
