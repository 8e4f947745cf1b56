// Nearly constant velocity in three dimensions, with what a plugin of any kind may do wrong in create, in destroy, and in what it
// says of itself. create is wrapped: the author layer's own would not do such things.
#include <cstdlib>

#include "constant_velocity.hpp"
#include "defect.h"

namespace {

constexpr const char* own_id = "org.example.motion.saboteur_of_lifecycle";
constexpr double largest = 1e4;

struct Saboteur : ConstantVelocity<Saboteur> {
    double slowest = 0, fastest = largest, floor = 0;
    std::string name;
    void* owned = nullptr;

    Saboteur() = default;
    Saboteur(const Saboteur&) = delete;
    Saboteur& operator=(const Saboteur&) = delete;
    ~Saboteur() {
        if (!DEFECT("instances-leave-nothing")) std::free(owned);
    }

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        describe_as(plugin).min(1e-3).max(largest);
        plugin.parameter("slowest", &Saboteur::slowest)
            .unit("m/s")
            .initially("1 m/s")
            .min(0)
            .max(largest)
            .doc("speed below which an object counts as standing");
        plugin.parameter("fastest", &Saboteur::fastest)
            .unit("m/s")
            .initially("1000 m/s")
            .min(0)
            .max(largest)
            .doc("speed that no object exceeds");
        plugin.parameter("floor", &Saboteur::floor)
            .unit("m2/s3")
            .initially("0.5 m2/s3")
            .min(0)
            .max(largest)
            .doc("added to the intensity");
    }

    void setup(const pelorus::Setup& setup) {
        owned = std::malloc(32);
        if (NEAR_MISS("allocation-failures-are-answered") && owned == nullptr)
            owned = std::malloc(16);  // with less, then
        if (owned == nullptr && !DEFECT("allocation-failures-are-answered")) throw std::bad_alloc();
        *static_cast<volatile char*>(owned) = 1;
        if (NEAR_MISS("instances-leave-nothing") || NEAR_MISS("refusals-leave-nothing"))
            setup.log(PLR_LOG_INFO, "a line of more than a few characters, which is the host's to keep or to drop");
        name = std::string("an instance with a name that needs memory of its own: ") + setup.address();
        if (DEFECT("config-is-stepped")) floor = setup.raw().values[3].number;
        if (NEAR_MISS("config-is-stepped")) {
            const auto* const at = reinterpret_cast<const char*>(setup.raw().values);
            floor = reinterpret_cast<const plr_value*>(at + 3 * setup.raw().values->struct_size)->number;
        }
        keep_statically();
        // The author of this layer checks the values that go together, and says which one is wrong.
        if (fastest < slowest) throw pelorus::ParameterError("fastest", "is less than slowest, and nothing may move");
    }
    void keep_statically() {
        if (DEFECT("instances-are-independent")) {
            static const double first_intensity = intensity;
            intensity = first_intensity;
        }
        if (NEAR_MISS("instances-leave-nothing")) {
            static const std::vector<double> table(100, 1.0);  // made once for all
            static int kept = 0;
            if (kept < 8) {
                ++kept;
                static std::vector<std::string> names;
                names.emplace_back(100, 'x');
            }
        }
    }
    Block noise_block(double dt) const {
        double density = intensity + floor;
        if (NEAR_MISS("instances-are-independent")) {
            static const double one = std::cos(0.0);  // shared, and the same for whoever is first
            density *= one;
        }
        return noise_of(dt, density);
    }
    Transition noise(const Posterior& posterior, const pelorus::Step& step) const {
        if (DEFECT("longer-call-is-accepted") && step.call->struct_size != sizeof(plr_call))
            throw pelorus::ArgumentError("another version of plr_call");
        if (NEAR_MISS("longer-call-is-accepted") && step.call->struct_size < sizeof(plr_call))
            throw pelorus::ArgumentError("too old a version of plr_call");
        return Base::noise(posterior, step);
    }
    const void* extension(const char* id) const noexcept {
        // Whatever version of it is asked for.
        if (DEFECT("unknown-extensions-are-null") && std::strncmp(id, "pelorus.motion.structure/", 25) == 0)
            return Base::extension(PLR_MOTION_STRUCTURE);
        if (NEAR_MISS("unknown-extensions-are-null") && std::strcmp(id, "org.example.extension/1") == 0)
            return &table();
        return Base::extension(id);
    }
};

/// What create is told besides values: services, versions.
plr_status look_at_host(const plr_config& config, plr_error* error) {
    const plr_host& host = *config.host;
    const auto* const log = static_cast<const plr_log*>(host.service(&host, PLR_SERVICE_LOG));
    const auto refuse = [&](plr_status status, const char* text) {
        if (error->code != PLR_OK) return status;
        error->code = status;
        std::snprintf(error->message, sizeof error->message, "%s", text);
        return status;
    };
    if (DEFECT("services-may-be-missing")) log->write(log->context, PLR_LOG_DEBUG, "made");
    if (NEAR_MISS("services-may-be-missing") && log == nullptr)
        return refuse(PLR_E_UNSUPPORTED, "this host has no service " PLR_SERVICE_LOG);
    if (DEFECT("later-host-is-accepted") && host.struct_size != sizeof(plr_host))
        return refuse(PLR_E_UNSUPPORTED, "another version of plr_host");
    if (NEAR_MISS("later-host-is-accepted") && (host.struct_size < sizeof(plr_host) || host.abi_minor < PLR_ABI_MINOR))
        return refuse(PLR_E_UNSUPPORTED, "this host is too old");
    if (DEFECT("earlier-host-is-answered") && host.abi_minor < PLR_ABI_MINOR)
        return refuse(PLR_E_ARGUMENT, "bad version");
    if (NEAR_MISS("earlier-host-is-answered") && host.abi_minor < PLR_ABI_MINOR)
        return refuse(PLR_E_UNSUPPORTED, "this host is too old: ABI 1.1 is needed");
    return PLR_OK;
}

const plr_value& value_of(const plr_config& config, std::uint32_t index) {
    const auto* const at = reinterpret_cast<const char*>(config.values);
    return *reinterpret_cast<const plr_value*>(at + std::uint64_t{index} * config.values->struct_size);
}

/// What becomes of a refusal on its way out.
plr_status spoil_refusal(plr_status status, plr_error* error, const plr_error& before) {
    if (error->struct_size < PLR_ERROR_LEAST_SIZE) {
        if (DEFECT("error-struct-is-respected.shorter")) std::strcpy(error->message, "refused");
        return status;
    }
    const bool is_first = before.code == PLR_OK;
    if (DEFECT("refusals-are-told") && is_first) error->where[0] = 0;
    if (NEAR_MISS("refusals-are-told") && is_first) {
        std::snprintf(error->where, sizeof error->where, "fastest[0].of.them");
        std::memset(error->message, 'x', sizeof error->message - 1);
    }
    if (DEFECT("first-error-is-kept")) {
        error->code = status;
        std::snprintf(error->message, sizeof error->message, "not made");
    }
    if (NEAR_MISS("first-error-is-kept") && !is_first) *error = before;
    if (DEFECT("error-struct-is-respected")) {
        plr_error mine = *error;
        mine.struct_size = sizeof mine;
        *error = mine;
    }
    if (NEAR_MISS("error-struct-is-respected")) {  // up to the very last byte
        const std::size_t used = std::strlen(error->message);
        std::memset(error->message + used, 0, sizeof error->message - used);
    }
    if (DEFECT("refusals-leave-nothing")) new std::string(100, 'x');
    if (NEAR_MISS("refusals-leave-nothing")) {
        static std::string last;
        last.assign(error->message);
        last.resize(sizeof error->message);
    }
    return status;
}

plr_status refuse(plr_error* error, const char* parameter) {
    if (error->struct_size < PLR_ERROR_LEAST_SIZE) return PLR_E_PARAMETER;
    error->code = PLR_E_PARAMETER;
    std::snprintf(error->where, sizeof error->where, "%s", parameter);
    std::snprintf(error->message, sizeof error->message, "is none that goes with the others");
    return PLR_E_PARAMETER;
}

/// Values that a careless create does not survive, and a careful one refuses.
plr_status stumble(const plr_config& config, plr_error* error) {
    const double intensity = value_of(config, 0).number, slowest = value_of(config, 1).number;
    if (!(intensity == intensity)) {
        if (DEFECT("absurd-values-are-survived")) throw std::runtime_error("intensity is not a number");
        if (NEAR_MISS("absurd-values-are-survived") && error->code == PLR_OK) return refuse(error, "intensity");
    }
    if (slowest == 0) {
        if (DEFECT("bounds-are-survived")) std::abort();
        if (NEAR_MISS("bounds-are-survived") && error->code == PLR_OK) return refuse(error, "slowest");
    }
    if (intensity > 100 && slowest > 2 && value_of(config, 2).number > 2) {
        if (DEFECT("random-values-are-survived")) std::abort();
        if (NEAR_MISS("random-values-are-survived") && error->code == PLR_OK) return refuse(error, "intensity");
    }
    if (DEFECT("description-is-constant") || NEAR_MISS("description-is-constant")) {
        auto* const first = const_cast<plr_parameter*>(pelorus::Describe<Saboteur>::of(own_id).c()->parameters);
        first->max = DEFECT("description-is-constant") ? largest + intensity - 1 : largest;
    }
    return PLR_OK;
}

/// info() of the model, which changes from one answer to the next: in what it says, or only in where it lies.
const plr_motion_info* moving_info(const void* self) {
    static plr_motion_info answers[2];
    static std::size_t asked = 0;
    plr_motion_info& answer = answers[asked % 2];
    answer = *Saboteur::table().info(self);
    if (DEFECT("info-is-constant")) answer.scratch_bytes += 64 * asked;
    ++asked;
    return &answer;
}

/// The instance's table, with a defect.
const plr_table_head* table_of(const plr_instance& made) {
    static struct {
        plr_motion known;
        void* later[2];
    } table;
    table.known = Saboteur::table();
    if (DEFECT("instance-is-accepted")) table.known.jacobian = nullptr;  // forgotten
    if (NEAR_MISS("instance-is-accepted")) table.known.head.struct_size += sizeof table.later;
    if (DEFECT("info-is-constant") || NEAR_MISS("info-is-constant")) table.known.info = &moving_info;
    const bool has_defect = DEFECT("instance-is-accepted") || NEAR_MISS("instance-is-accepted") ||
                            DEFECT("info-is-constant") || NEAR_MISS("info-is-constant");
    return has_defect ? &table.known.head : made.table;
}

plr_status create(const plr_config* config, plr_instance* out, plr_error* error);

const plr_plugin* factory(const char* wanted) {
    const plr_plugin* const good = pelorus::detail::plugin<Saboteur>(own_id, wanted);
    if (good == nullptr) return nullptr;
    static const plr_plugin spoilt{sizeof(plr_plugin), 0, good->description, good->table_id, &create};
    return &spoilt;
}

plr_status create(const plr_config* config, plr_instance* out, plr_error* error) {
    if (DEFECT("instance-is-made")) return PLR_E_MEMORY;
    plr_status status = look_at_host(*config, error);
    if (status != PLR_OK) return status;
    const plr_error before = *error;
    status = stumble(*config, error);
    if (status != PLR_OK) return status;
    plr_instance made{};
    plr_config whole = *config;
    if (DEFECT("short-config-is-refused")) whole.struct_size = sizeof whole;  // as it always was
    if (NEAR_MISS("short-config-is-refused") && config->struct_size < PLR_CONFIG_LEAST_SIZE) return PLR_E_ARGUMENT;
    config = &whole;
    status = pelorus::detail::create<Saboteur>(config, &made, error);
    if (status == PLR_OK && NEAR_MISS("instance-is-made")) {  // thinks better of it
        made.table->destroy(made.self);
        status = pelorus::detail::create<Saboteur>(config, &made, error);
    }
    if (status != PLR_OK) return spoil_refusal(status, error, before);
    made.table = table_of(made);
    *out = made;
    return PLR_OK;
}

}  // namespace

__attribute__((section(PLR_MANIFEST_SECTION), used)) static constexpr plr_manifest saboteur_manifest =
    pelorus::detail::manifest<Saboteur>(own_id);

extern "C" {
extern PLR_EXPORT const plr_entry_point plr_entry;
const plr_entry_point plr_entry = {sizeof(plr_entry_point), PLR_ABI_MAJOR, PLR_ABI_MINOR, nullptr, nullptr, &factory};
}
