/// How a C++ plugin describes itself: parameters are declared once, bound to the members they end up in.
///
///     static void describe(pelorus::Describe<Singer>& plugin) {
///         plugin.title("Singer manoeuvre model").source("R. A. Singer, ..., 1970, eq. 12");
///         plugin.parameter("maneuver_rate", &Singer::maneuver_rate).unit("1/s").initially("0.1 1/s").min(0)
///             .doc("reciprocal of the manoeuvre's time constant");
///     }
///
/// The member's type says the parameter's: bool, int, std::int64_t, double, std::string, an enum (with choices),
/// std::filesystem::path, Vector<N>, std::vector<double>, Eigen::MatrixXd, std::vector<Row> (a table), std::optional of those.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <pelorus/abi/plugin.h>
#include <pelorus/matrix.hpp>

namespace pelorus {

namespace detail {

template <class T> struct is_optional : std::false_type {};
template <class T> struct is_optional<std::optional<T>> : std::true_type {};
template <class T> struct fixed_vector : std::false_type {};
template <int N> struct fixed_vector<Eigen::Matrix<double, N, 1>> : std::bool_constant<(N > 0)> {
    static constexpr int size = N;
};

/// The ABI's type word for a member's type.
template <class T> constexpr std::uint32_t parameter_type() {
    if constexpr (is_optional<T>::value)
        return parameter_type<typename T::value_type>();
    else if constexpr (std::is_same_v<T, bool>)
        return PLR_TYPE_BOOL;
    else if constexpr (std::is_enum_v<T>)
        return PLR_TYPE_CHOICE;
    else if constexpr (std::is_integral_v<T>)
        return PLR_TYPE_INT;
    else if constexpr (std::is_floating_point_v<T>)
        return PLR_TYPE_DOUBLE;
    else if constexpr (std::is_same_v<T, std::string>)
        return PLR_TYPE_STRING;
    else if constexpr (std::is_same_v<T, std::filesystem::path>)
        return PLR_TYPE_PATH;
    else if constexpr (std::is_same_v<T, Eigen::MatrixXd>)
        return PLR_TYPE_MATRIX;
    else if constexpr (fixed_vector<T>::value || std::is_same_v<T, std::vector<double>>)
        return PLR_TYPE_VECTOR;
    else
        return PLR_TYPE_TABLE;
}

/// Moves a parsed value into a member.
template <class T> void assign(T& member, const plr_value& value) {
    if constexpr (is_optional<T>::value) {
        if (value.present == 0) {
            member.reset();
        } else {
            typename T::value_type inner{};
            assign(inner, value);
            member = std::move(inner);
        }
    } else if constexpr (std::is_same_v<T, bool>) {
        member = value.integer != 0;
    } else if constexpr (std::is_enum_v<T> || std::is_integral_v<T>) {
        member = static_cast<T>(value.integer);
    } else if constexpr (std::is_floating_point_v<T>) {
        member = value.number;
    } else if constexpr (std::is_same_v<T, std::string> || std::is_same_v<T, std::filesystem::path>) {
        member = value.text == nullptr ? "" : value.text;
    } else if constexpr (fixed_vector<T>::value) {
        member = load<fixed_vector<T>::size, 1>(value.numbers, 0);
    } else if constexpr (std::is_same_v<T, std::vector<double>>) {
        member.clear();
        for (std::int64_t r = 0; r < value.numbers.rows; ++r)
            member.push_back(value.numbers.data[r * value.numbers.row_stride]);
    } else {
        member.resize(value.numbers.rows, value.numbers.cols);
        for (std::int64_t c = 0; c < member.cols(); ++c)
            for (std::int64_t r = 0; r < member.rows(); ++r)
                member(r, c) = value.numbers.data[c * value.numbers.col_stride + r * value.numbers.row_stride];
    }
}

/// One parameter or column under construction; text is owned.
struct ParameterText {
    plr_parameter raw{};
    std::string name, doc, unit, initially;
    bool has_default = false;
    std::vector<std::string> choices, choice_docs;
    std::vector<const char*> choice_pointers, choice_doc_pointers;
    std::vector<std::unique_ptr<ParameterText>> columns;
    std::vector<plr_parameter> raw_columns;

    explicit ParameterText(std::string name_, std::uint32_t type) : name(std::move(name_)) {
        raw.struct_size = sizeof(plr_parameter);
        raw.type = type;
        raw.min = -std::numeric_limits<double>::infinity();
        raw.max = std::numeric_limits<double>::infinity();
        raw.rows_min = 0;
        raw.rows_max = -1;
        raw.cols_min = 0;
        raw.cols_max = -1;
    }
    /// Sets all pointers; called once, when everything is in its final place.
    const plr_parameter& finish() {
        for (const auto& c : choices) choice_pointers.push_back(c.c_str());
        for (const auto& c : choice_docs) choice_doc_pointers.push_back(c.c_str());
        for (auto& c : columns) raw_columns.push_back(c->finish());
        raw.name = name.c_str();
        raw.doc = doc.c_str();
        raw.unit = unit.c_str();
        raw.default_text = has_default ? initially.c_str() : nullptr;
        if (!has_default && (raw.flags & PLR_PARAMETER_OPTIONAL) == 0) raw.flags |= PLR_PARAMETER_REQUIRED;
        raw.choices = choice_pointers.data();
        raw.choice_docs = choice_doc_pointers.empty() ? nullptr : choice_doc_pointers.data();
        raw.choice_count = static_cast<std::uint32_t>(choice_pointers.size());
        raw.columns = raw_columns.data();
        raw.column_count = static_cast<std::uint32_t>(raw_columns.size());
        return raw;
    }
};

}  // namespace detail

/// What one can say of a parameter; every function returns the same object, so that calls chain.
class ParameterBuilder {
public:
    explicit ParameterBuilder(detail::ParameterText& text) : text_(text) {}
    ParameterBuilder& unit(std::string si) { return set(text_.unit, std::move(si)); }
    ParameterBuilder& doc(std::string sentence) { return set(text_.doc, std::move(sentence)); }
    /// The default, as one would write it in a config. Without it the parameter is required.
    ParameterBuilder& initially(std::string value) {
        text_.has_default = true;
        return set(text_.initially, std::move(value));
    }
    ParameterBuilder& min(double bound) { return text_.raw.min = bound, *this; }
    ParameterBuilder& max(double bound) { return text_.raw.max = bound, *this; }
    ParameterBuilder& above(double bound) { return text_.raw.flags |= PLR_PARAMETER_MIN_EXCLUSIVE, min(bound); }
    ParameterBuilder& below(double bound) { return text_.raw.flags |= PLR_PARAMETER_MAX_EXCLUSIVE, max(bound); }
    /// The words of a choice, in the order of the enumerators, each with a sentence (or "").
    ParameterBuilder& choices(const std::vector<std::pair<std::string, std::string>>& words) {
        for (const auto& [word, sentence] : words) {
            text_.choices.push_back(word);
            text_.choice_docs.push_back(sentence);
        }
        return *this;
    }
    /// Length of a vector, rows of a matrix or table.
    ParameterBuilder& rows(int at_least, int at_most = -1) {
        text_.raw.rows_min = at_least;
        text_.raw.rows_max = at_most;
        return *this;
    }
    ParameterBuilder& cols(int at_least, int at_most) {
        text_.raw.cols_min = at_least;
        text_.raw.cols_max = at_most;
        return *this;
    }

private:
    ParameterBuilder& set(std::string& to, std::string value) { return to = std::move(value), *this; }
    detail::ParameterText& text_;
};

/// A parameter that is a list of rows, each a struct. Columns: bool, int, double, std::string, enums.
template <class Row> class TableBuilder {
public:
    using Setter = std::function<void(Row&, const plr_value&)>;
    TableBuilder(detail::ParameterText& text, std::shared_ptr<std::vector<Setter>> setters)
        : text_(text), setters_(std::move(setters)) {}
    TableBuilder& doc(std::string sentence) { return text_.doc = std::move(sentence), *this; }
    TableBuilder& initially(std::string value) {
        text_.has_default = true;
        return text_.initially = std::move(value), *this;
    }
    TableBuilder& rows(int at_least, int at_most = -1) {
        text_.raw.rows_min = at_least;
        text_.raw.rows_max = at_most;
        return *this;
    }
    template <class T> ParameterBuilder column(std::string name, T Row::*member) {
        text_.columns.push_back(std::make_unique<detail::ParameterText>(std::move(name), detail::parameter_type<T>()));
        if constexpr (detail::is_optional<T>::value) text_.columns.back()->raw.flags |= PLR_PARAMETER_OPTIONAL;
        setters_->push_back([member](Row& row, const plr_value& cell) { detail::assign(row.*member, cell); });
        return ParameterBuilder(*text_.columns.back());
    }

private:
    detail::ParameterText& text_;
    std::shared_ptr<std::vector<Setter>> setters_;
};

/// The description of the plugin class T: built once, on the first question, by T::describe.
template <class T> class Describe {
public:
    /// The one description of T. `id` counts on the first call only.
    static const Describe& of(const char* id = "") {
        static const Describe description(id);
        return description;
    }

    Describe& title(std::string words) { return title_ = std::move(words), *this; }
    Describe& purpose(std::string paragraph) { return purpose_ = std::move(paragraph), *this; }
    Describe& equation(std::string text) { return equation_ = std::move(text), *this; }
    Describe& source(std::string citation) { return source_ = std::move(citation), *this; }
    Describe& license(std::string spdx) { return license_ = std::move(spdx), *this; }
    Describe& flags(std::uint32_t bits) { return flags_ |= bits, *this; }

    /// A parameter of the plugin, bound to a member of T (or of a base of T).
    template <class Base, class M> ParameterBuilder parameter(std::string name, M Base::*member) {
        static_assert(std::is_base_of_v<Base, T> || std::is_same_v<Base, T>, "the member is not one of this plugin");
        auto& text = parameters_.emplace_back(std::move(name), detail::parameter_type<M>());
        static_assert(detail::parameter_type<M>() != PLR_TYPE_TABLE, "tables are declared with table()");
        if constexpr (detail::is_optional<M>::value) text.raw.flags |= PLR_PARAMETER_OPTIONAL;
        if constexpr (detail::fixed_vector<M>::value)
            text.raw.rows_min = text.raw.rows_max = detail::fixed_vector<M>::size;
        binders_.push_back([member](T& self, const plr_value& value) { detail::assign(self.*member, value); });
        return ParameterBuilder(text);
    }

    /// A list of rows.
    template <class Base, class Row> TableBuilder<Row> table(std::string name, std::vector<Row> Base::*member) {
        auto& text = parameters_.emplace_back(std::move(name), std::uint32_t{PLR_TYPE_TABLE});
        auto setters = std::make_shared<std::vector<typename TableBuilder<Row>::Setter>>();
        binders_.push_back([member, setters, &text](T& self, const plr_value& value) {
            (self.*member).clear();
            for (std::int64_t r = 0; r < value.numbers.rows; ++r) {
                Row row{};
                for (std::size_t c = 0; c < setters->size(); ++c) (*setters)[c](row, cell(value, text, r, c));
                (self.*member).push_back(std::move(row));
            }
        });
        return TableBuilder<Row>(text, setters);
    }

    /// Something that is read in each call (see inputs() of the model classes).
    Describe& input(std::string name, std::string unit, std::vector<double> defaults, std::string doc) {
        inputs_.push_back({std::move(name), std::move(unit), std::move(doc), std::move(defaults)});
        return *this;
    }

    /// A place for other plugins; at_most -1: any number. Parameters that the holder asks of each part are declared with
    /// slot_parameter right after it.
    Describe& slot(std::string name, std::string kind, int at_least, int at_most, std::string doc) {
        slots_.push_back({std::move(name), std::move(kind), std::move(doc), at_least, at_most, {}, {}, {}});
        return *this;
    }
    /// A parameter of the parts of the last slot, bound to a member of the struct `Values` that Setup::slot_values fills.
    template <class Values, class M> ParameterBuilder slot_parameter(std::string name, M Values::*member) {
        auto& text = slots_.back().parameters.emplace_back(std::move(name), detail::parameter_type<M>());
        slots_.back().binders.push_back([member](void* values, const plr_value& value) {
            detail::assign(static_cast<Values*>(values)->*member, value);
        });
        if constexpr (detail::is_optional<M>::value) text.raw.flags |= PLR_PARAMETER_OPTIONAL;
        if constexpr (detail::fixed_vector<M>::value)
            text.raw.rows_min = text.raw.rows_max = detail::fixed_vector<M>::size;
        return ParameterBuilder(text);
    }

    /// Ports of stages. `message` is PLR_MESSAGE_..., flags PLR_PORT_... . Ports are numbered in the order of declaration.
    Describe& in_port(std::string name, std::uint32_t message, std::string doc, std::uint32_t flags = 0) {
        in_ports_.push_back({std::move(name), std::move(doc), message, flags});
        return *this;
    }
    Describe& out_port(std::string name, std::uint32_t message, std::string doc) {
        out_ports_.push_back({std::move(name), std::move(doc), message, 0});
        return *this;
    }

    const plr_description* c() const noexcept { return &raw_; }

    /// Fills the bound members of `self` from parsed values.
    void bind(T& self, const plr_config& config) const {
        const char* at = reinterpret_cast<const char*>(config.values);
        for (std::size_t i = 0; i < binders_.size() && i < config.value_count; ++i) {
            const auto& value = *reinterpret_cast<const plr_value*>(at);
            binders_[i](self, value);
            at += value.struct_size;
        }
    }

    /// What the config says of a part for the parameters that its slot declares (see slot_parameter).
    template <class Values> Values slot_values(const plr_part& part) const {
        Values values{};
        for (const SlotText& slot : slots_) {
            if (slot.name != part.slot) continue;
            const char* at = reinterpret_cast<const char*>(part.values);
            for (std::size_t i = 0; i < slot.binders.size() && i < part.value_count; ++i) {
                const auto& value = *reinterpret_cast<const plr_value*>(at);
                slot.binders[i](&values, value);
                at += value.struct_size;
            }
        }
        return values;
    }

private:
    struct InputText {
        std::string name, unit, doc;
        std::vector<double> defaults;
    };
    struct SlotText {
        std::string name, kind, doc;
        int at_least, at_most;
        std::deque<detail::ParameterText> parameters;
        std::vector<plr_parameter> raw;
        std::vector<std::function<void(void*, const plr_value&)>> binders;
    };
    struct PortText {
        std::string name, doc;
        std::uint32_t message, flags;
    };

    explicit Describe(const char* id) : id_(id) {
        T::describe(*this);
        finish();
    }
    Describe(const Describe&) = delete;
    Describe& operator=(const Describe&) = delete;

    /// A table's cell as a value of its own.
    static plr_value cell(const plr_value& table, const detail::ParameterText& text, std::int64_t r, std::size_t c) {
        plr_value value{};
        value.struct_size = sizeof value;
        const auto column = static_cast<std::int64_t>(c);
        const auto columns = static_cast<std::int64_t>(text.columns.size());
        const double number = table.numbers.data[column * table.numbers.col_stride + r * table.numbers.row_stride];
        const char* words = table.texts == nullptr ? nullptr : table.texts[r * columns + column];
        const bool is_text = text.columns[c]->raw.type == PLR_TYPE_STRING;
        value.present = is_text ? words != nullptr : number == number;  // a missing cell is not a number
        value.number = number;
        value.integer = value.present != 0 && !is_text ? static_cast<std::int64_t>(number) : 0;
        value.text = words;
        return value;
    }

    void finish() {
        for (auto& p : parameters_) raw_parameters_.push_back(p.finish());
        for (auto& i : inputs_)
            raw_inputs_.push_back({sizeof(plr_input), static_cast<std::uint32_t>(i.defaults.size()), i.name.c_str(),
                                   i.unit.c_str(), i.doc.c_str(), i.defaults.data()});
        for (auto& s : slots_) {
            for (auto& p : s.parameters) s.raw.push_back(p.finish());
            raw_slots_.push_back({sizeof(plr_slot), s.at_least, s.at_most, static_cast<std::uint32_t>(s.raw.size()),
                                  s.name.c_str(), s.kind.c_str(), s.doc.c_str(), s.raw.data()});
        }
        const auto ports = [](const std::deque<PortText>& from, std::vector<plr_port>& to) {
            for (const auto& p : from)
                to.push_back({sizeof(plr_port), p.flags, p.name.c_str(), p.doc.c_str(), p.message, 0});
        };
        ports(in_ports_, raw_in_ports_);
        ports(out_ports_, raw_out_ports_);
        raw_ = {sizeof(plr_description),
                flags_,
                id_.c_str(),
                T::kind,
                T::version,
                title_.c_str(),
                purpose_.c_str(),
                equation_.c_str(),
                source_.c_str(),
                license_.c_str(),
                raw_parameters_.data(),
                raw_inputs_.data(),
                raw_slots_.data(),
                raw_in_ports_.data(),
                raw_out_ports_.data(),
                static_cast<std::uint32_t>(raw_parameters_.size()),
                static_cast<std::uint32_t>(raw_inputs_.size()),
                static_cast<std::uint32_t>(raw_slots_.size()),
                static_cast<std::uint32_t>(raw_in_ports_.size()),
                static_cast<std::uint32_t>(raw_out_ports_.size()),
                0};
    }

    std::string id_, title_, purpose_, equation_, source_, license_ = "Apache-2.0";
    std::uint32_t flags_ = 0;
    std::deque<detail::ParameterText> parameters_;
    std::vector<std::function<void(T&, const plr_value&)>> binders_;
    std::deque<InputText> inputs_;
    std::deque<SlotText> slots_;
    std::deque<PortText> in_ports_, out_ports_;
    std::vector<plr_parameter> raw_parameters_;
    std::vector<plr_input> raw_inputs_;
    std::vector<plr_slot> raw_slots_;
    std::vector<plr_port> raw_in_ports_, raw_out_ports_;
    plr_description raw_{};
};

}  // namespace pelorus
