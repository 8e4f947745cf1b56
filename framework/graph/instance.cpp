#include "graph/instance.hpp"

#include <algorithm>
#include <utility>

#include "graph/contract.hpp"
#include "host/description.hpp"
#include "host/plugin_error.hpp"

namespace pelorus::graph {

using host::element;

Instance::Instance(const PartPlan& plan, const host::InstanceHost::Shared& services)
    : plan_(plan), host_(plan.address, plan.description().id, services) {}

Instance::~Instance() {
    if (instance_.table == nullptr || instance_.table->struct_size < sizeof(plr_table_head) ||
        instance_.table->destroy == nullptr)
        return;
    guard_ = host::Guard();  // first: once destroyed, `self` may come back as another instance
    plr_error error = host::empty_error();
    const host::Breadcrumb crumb(mark("destroy"));
    const plr_status status = host::guarded(error, [&] {
        instance_.table->destroy(instance_.self);
        return PLR_OK;
    });
    if (status == PLR_OK) return;
    const plr_log& log = *host_.log();
    log.write(log.context, PLR_LOG_ERROR, ("destroy: " + host::error_text(status, error)).c_str());
}

host::CallMark Instance::mark(const char* call) const noexcept {
    host::CallMark mark{};
    mark.subject = plan_.address.c_str();
    mark.plugin = plan_.description().id;
    mark.call = call;
    return mark;
}

void Instance::set_guard(host::GuardMode mode, const std::shared_ptr<host::FaultLatch>& latch) {
    const plr_description& description = plan_.description();
    const std::size_t below = plan_.slot.size() + (plan_.name.empty() ? 0 : plan_.name.size() + 1);
    host::GuardedPart part;
    part.address = plan_.address;
    part.plugin = description.id;
    part.holder = plan_.address.substr(0, plan_.address.size() - std::min(plan_.address.size(), below + 1));
    part.table_id = plan_.plugin->plugin->table_id;
    part.instance = instance_;
    part.input_size = config_.input_size;
    part.cells_may_overlap = (description.flags & PLR_DESCRIPTION_OVERLAP) != 0;
    guard_ = host::Guard(part, mode, latch);
}

plr_part Instance::as_part() const {
    plr_part part{};
    part.struct_size = sizeof part;
    part.value_count = plan_.slot_values.size();
    part.slot = plan_.slot.c_str();
    part.name = plan_.name.c_str();
    part.address = plan_.address.c_str();
    part.table_id = plan_.plugin->plugin->table_id;
    part.description = &plan_.description();
    part.instance = guard_.is_on() ? guard_.instance() : instance_;
    part.values = plan_.slot_values.data();
    return part;
}

/// Creates one stage's tree. The flat array of inputs that the stage passes in its calls holds those of the stage first, then
/// those of its parts, each with its own parts following it.
class TreeBuilder {
public:
    TreeBuilder(const PartPlan& stage, const TreeContext& context, Instances& instances, Problems& problems)
        : context_(context), instances_(instances), problems_(problems) {
        lay_out(stage);
    }

    Instance* create(const PartPlan& plan) {
        std::vector<const Instance*> parts;
        bool is_complete = true;
        for (const std::unique_ptr<PartPlan>& below : plan.parts) {
            const Instance* part = create(*below);
            if (part == nullptr)
                is_complete = false;
            else
                parts.push_back(part);
        }
        if (!is_complete) return nullptr;
        auto instance = std::make_unique<Instance>(plan, context_.services);
        fill_config(*instance, parts);
        if (!call_create(*instance)) return nullptr;
        instances_.created_.push_back(std::move(instance));
        return instances_.created_.back().get();
    }

private:
    /// Offsets of own inputs, by part, in the order in which they lie.
    void lay_out(const PartPlan& plan) {
        offsets_[&plan] = size_;
        const plr_description& description = plan.description();
        for (std::uint32_t i = 0; i < description.input_count; ++i) size_ += element(description.inputs, i).size;
        for (const std::unique_ptr<PartPlan>& below : plan.parts) lay_out(*below);
    }

    /// The inputs of a part and all below it, own ones first, under names relative to the instance.
    void collect_inputs(const PartPlan& plan, const std::string& prefix, Instance& instance) const {
        const plr_description& description = plan.description();
        std::int64_t offset = offsets_.at(&plan);
        for (std::uint32_t i = 0; i < description.input_count; ++i) {
            const plr_input& input = element(description.inputs, i);
            instance.input_names_.push_back(prefix + input.name);
            instance.inputs_.push_back(
                {sizeof(plr_input_place), input.size, nullptr, input.unit, offset, input.defaults});
            offset += input.size;
        }
        for (const std::unique_ptr<PartPlan>& below : plan.parts)
            collect_inputs(*below, prefix + below->slot + "." + (below->name.empty() ? "" : below->name + "."),
                           instance);
    }

    void fill_config(Instance& instance, const std::vector<const Instance*>& parts) const {
        const PartPlan& plan = instance.plan_;
        for (const Instance* part : parts) instance.parts_.push_back(part->as_part());
        collect_inputs(plan, "", instance);
        for (std::size_t i = 0; i < instance.inputs_.size(); ++i)
            instance.inputs_[i].name = instance.input_names_[i].c_str();
        plr_config& config = instance.config_;
        config.struct_size = sizeof config;
        config.value_count = plan.values.size();
        config.address = plan.address.c_str();
        config.values = plan.values.data();
        config.parts = instance.parts_.data();
        config.part_count = static_cast<std::uint32_t>(instance.parts_.size());
        config.input_count = static_cast<std::uint32_t>(instance.inputs_.size());
        config.inputs = instance.inputs_.data();
        config.input_offset = offsets_.at(&plan);
        config.input_size = size_;
        config.key = context_.key;
        config.frame = context_.frame;
        config.host = instance.host_.host();
    }

    bool call_create(Instance& instance) {
        const PartPlan& plan = instance.plan_;
        const std::string id = plan.description().id;
        plr_error error = host::empty_error();
        plr_instance made{};
        const plr_status status = host::guarded(error, [&] {
            const host::Breadcrumb crumb(instance.mark("create"));
            return plan.plugin->plugin->create(&instance.config_, &made, &error);
        });
        if (status == PLR_OK) instance.instance_ = made;
        const host::FaultLatch* const faults = instance.host_.faults();
        if (faults != nullptr && faults->is_set()) {  // a part's, whatever its holder makes of it
            problems_.add(plan.use_where, faults->line());
            return false;
        }
        if (status != PLR_OK) {
            const std::string where = host::one_line(error.where, sizeof error.where);
            error.where[0] = '\0';
            problems_.add(place_of(plan, where), plan.address + (where.empty() ? "" : "." + where) + ": " + id + ": " +
                                                     host::error_text(status, error));
            return false;
        }
        const host::Breadcrumb crumb(instance.mark("info"));
        const std::string problem = instance_problem(plan.plugin->plugin->table_id, plan.description(), made);
        if (!problem.empty())
            problems_.add(plan.use_where, plan.address + ": " + id + " breaks the contract: " + problem);
        else if (!plan.slot.empty())
            instance.set_guard(context_.guard, context_.services.faults);
        return problem.empty();
    }

    const TreeContext& context_;
    Instances& instances_;
    Problems& problems_;
    std::map<const PartPlan*, std::int64_t> offsets_;
    std::int64_t size_ = 0;
};

Instances::~Instances() { clear(); }

void Instances::clear() noexcept {
    while (!created_.empty()) created_.pop_back();
}

std::vector<plr_part> Instances::models() const {
    std::vector<plr_part> found;
    for (const std::unique_ptr<Instance>& instance : created_)
        if (!instance->plan().slot.empty()) found.push_back(instance->as_part());
    return found;
}

Instance* Instances::create(const PartPlan& stage, const TreeContext& context, Problems& problems) {
    return TreeBuilder(stage, context, *this, problems).create(stage);
}

}  // namespace pelorus::graph
