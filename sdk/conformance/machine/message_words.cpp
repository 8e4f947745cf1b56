#include "message_words.hpp"

#include <algorithm>
#include <cstdio>
#include <type_traits>

#include "message_fields.hpp"

namespace pelorus::conformance {

namespace {

template <class Number> std::string number_text(Number number) {
    if constexpr (std::is_floating_point_v<Number>) {
        char text[40];
        std::snprintf(text, sizeof text, "%.17g", number);
        return text;
    } else {
        return std::to_string(number);
    }
}

class Words {
public:
    explicit Words(MessageWords& words) : words_(words) {}

    void text(const char* name, const char*& text) { add(name, text == nullptr ? "NULL" : text); }
    template <class Number> void number(const char* name, Number& number) { add(name, number_text(number)); }
    template <class Number> void array(const char* name, const Number*& first, std::int64_t count) {
        if (first == nullptr) return;
        for (std::int64_t i = 0; i < count; ++i) add(name + ("[" + std::to_string(i) + "]"), number_text(first[i]));
    }
    void texts(const char* name, const char* const*& first, std::uint32_t count) {
        if (first == nullptr) return;
        for (std::uint32_t i = 0; i < count; ++i) add(name + ("[" + std::to_string(i) + "]"), first[i]);
    }
    void view(const char* name, plr_const_view& view) {
        if (view.data == nullptr) return;
        for (std::int64_t i = 0; i < view.count; ++i)
            for (std::int64_t c = 0; c < view.cols; ++c)
                for (std::int64_t r = 0; r < view.rows; ++r)
                    add(name + ("[" + std::to_string(r) +
                                (view.cols > 1 ? ", " + std::to_string(c) + "]" : std::string("]")) + " of entry " +
                                std::to_string(i)),
                        number_text(view.data[i * view.item_stride + c * view.col_stride + r * view.row_stride]));
    }
    void space(const char* name, const plr_space*& space) {
        if (space == nullptr) return;
        plr_space copy = *space;
        within(name, [&] { visit_fields(*this, copy); });
    }
    template <class Struct> void elements(const char* name, const Struct*& first, std::uint32_t count) {
        for (std::uint32_t i = 0; i < count; ++i) {
            Struct copy = element_of(first, i);
            within(name + ("[" + std::to_string(i) + "]"), [&] { visit_fields(*this, copy); });
        }
    }
    template <class Body> void body(const Body*& given) {
        Body copy = *given;
        visit_fields(*this, copy);
    }

private:
    void add(const std::string& name, std::string value) { words_.emplace_back(prefix_ + name, std::move(value)); }
    template <class Inner> void within(const std::string& name, Inner&& inner) {
        const std::string outer = prefix_;
        prefix_ += name + ".";
        inner();
        prefix_ = outer;
    }

    MessageWords& words_;
    std::string prefix_;
};

std::string count_text(std::int64_t count) {
    return " (" + std::to_string(count) + (count == 1 ? " entry)" : " entries)");
}

}  // namespace

const char* message_kind_name(std::uint32_t kind) noexcept {
    static const char* const names[] = {"message", "scan", "tracks", "truth", "values", "table"};
    return names[kind <= PLR_MESSAGE_TABLE ? kind : 0];
}

std::string brief(const plr_message& message) {
    std::string text = message_kind_name(message.kind);
    if (message.kind == PLR_MESSAGE_SCAN) text += std::string(" of sensor ") + message.body.scan->sensor;
    if (message.kind == PLR_MESSAGE_TABLE) text += std::string(" `") + message.body.table->name + "`";
    char time[40];
    std::snprintf(time, sizeof time, " at %.9g s", static_cast<double>(message.time) * 1e-9);
    text += time;
    if (message.kind == PLR_MESSAGE_SCAN) text += count_text(message.body.scan->measurements.count);
    if (message.kind == PLR_MESSAGE_TRACKS) text += count_text(message.body.tracks->count);
    if (message.kind == PLR_MESSAGE_TRUTH) text += count_text(message.body.truth->count);
    return text;
}

MessageWords words_of(const plr_message& message) {
    MessageWords words;
    plr_message copy = message;
    Words visitor(words);
    visitor.number("kind", copy.kind);
    visitor.number("time", copy.time);
    visitor.number("arrival", copy.arrival);
    visit_body(visitor, copy);
    return words;
}

std::string difference_of(const plr_message& one, const plr_message& other) {
    const MessageWords mine = words_of(one), theirs = words_of(other);
    for (std::size_t i = 0; i < std::min(mine.size(), theirs.size()); ++i) {
        if (mine[i] == theirs[i]) continue;
        if (mine[i].first != theirs[i].first) return mine[i].first + " against " + theirs[i].first;
        return mine[i].first + ": " + mine[i].second + " against " + theirs[i].second;
    }
    if (mine.size() == theirs.size()) return {};
    return "one goes on with " + (mine.size() > theirs.size() ? mine[theirs.size()] : theirs[mine.size()]).first;
}

}  // namespace pelorus::conformance
