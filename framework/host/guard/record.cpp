#include "host/guard/record.hpp"

#include "host/error.hpp"
#include "host/plugin_error.hpp"

namespace pelorus::host {

GuardMode guard_mode(const std::string& word) {
    if (word == "off") return GuardMode::off;
    if (word == "start") return GuardMode::start;
    if (word == "all") return GuardMode::all;
    const std::string near = nearest(word, {"off", "start", "all"});
    throw Error(Exit::misuse, "--guard: expected one of off, start, all, got '" + word + "'" +
                                  (near.empty() ? "" : "; did you mean '" + near + "'?"));
}

std::string GuardSizes::difference(const GuardSizes& made_with, const GuardSizes& now) {
    struct Named {
        std::int64_t GuardSizes::*size;
        const char* name;
    };
    static constexpr Named all[] = {{&GuardSizes::n, "state components"},
                                    {&GuardSizes::c, "Cartesian components"},
                                    {&GuardSizes::m, "measurement components"},
                                    {&GuardSizes::i, "components of the inverse"},
                                    {&GuardSizes::w, "waveform parameters"},
                                    {&GuardSizes::r, "doubles of record"},
                                    {&GuardSizes::d, "dimensions"},
                                    {&GuardSizes::least_d, "dimensions at least"},
                                    {&GuardSizes::o, "objects"},
                                    {&GuardSizes::h, "steps of horizon"},
                                    {&GuardSizes::version, "as the record's version"},
                                    {&GuardSizes::flags, "as flags"},
                                    {&GuardSizes::scratch, "bytes of scratch memory"}};
    for (const Named& one : all)
        if (made_with.*one.size != now.*one.size)
            return "info() answers " + std::to_string(now.*one.size) + " " + one.name + ", it answered " +
                   std::to_string(made_with.*one.size) + " when the instance was made";
    return made_with.ms == now.ms ? "" : "info() answers other sensors than when the instance was made";
}

plr_status GuardRecord::fail(plr_error* error, plr_status code, std::int64_t item,
                             const std::string& line) const noexcept {
    if (latch != nullptr) latch->set(line);
    if (error == nullptr) return code;
    error->code = PLR_OK;
    error->item = item;
    return tell(error, code, line);
}

}  // namespace pelorus::host
