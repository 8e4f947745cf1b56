#include "lent_message.hpp"

#include <cstring>

#include "message_fields.hpp"

namespace pelorus::conformance {

namespace {

/// Counts the bytes of a copy (no memory given) or makes it.
class Copier {
public:
    explicit Copier(unsigned char* memory) : memory_(memory) {}
    std::size_t used() const noexcept { return used_; }

    /// Copies `count` structs or numbers and lets the pointer point to the copies.
    template <class T> T* take(const T*& first, std::size_t count) {
        used_ = (used_ + alignof(std::max_align_t) - 1) / alignof(std::max_align_t) * alignof(std::max_align_t);
        T* const to = memory_ == nullptr ? nullptr : reinterpret_cast<T*>(memory_ + used_);
        if (to != nullptr) std::memcpy(static_cast<void*>(to), first, count * sizeof(T));
        used_ += count * sizeof(T);
        if (to != nullptr) first = to;
        return to;
    }
    void text(const char*, const char*& text) {
        if (text != nullptr) take(text, std::strlen(text) + 1);
    }
    template <class Number> void number(const char*, Number&) {}
    template <class Number> void array(const char*, const Number*& first, std::int64_t count) {
        if (first != nullptr) take(first, static_cast<std::size_t>(count));
    }
    void texts(const char*, const char* const*& first, std::uint32_t count) {
        if (first == nullptr) return;
        const char* const* given = first;
        const char** const copies = const_cast<const char**>(take(first, count));
        for (std::uint32_t i = 0; i < count; ++i) {
            const char* text = given[i];
            take(text, std::strlen(text) + 1);
            if (copies != nullptr) copies[i] = text;
        }
    }
    void view(const char*, plr_const_view& view) {
        if (view.data == nullptr) return;
        const std::int64_t last = view.count == 0 || view.rows * view.cols == 0
                                      ? -1
                                      : (view.count - 1) * view.item_stride + (view.cols - 1) * view.col_stride +
                                            (view.rows - 1) * view.row_stride;
        take(view.data, static_cast<std::size_t>(last + 1));
    }
    void space(const char*, const plr_space*& space) {
        if (space == nullptr) return;
        plr_space inner = *space;
        plr_space* const copy = take(space, 1);
        visit_fields(*this, inner);
        if (copy != nullptr) *copy = inner;
    }
    template <class Struct> void elements(const char*, const Struct*& first, std::uint32_t count) {
        if (count == 0) return;
        const Struct* const given = first;
        Struct* const copies = take(first, count);
        for (std::uint32_t i = 0; i < count; ++i) {
            Struct inner = element_of(given, i);
            inner.struct_size = sizeof inner;
            visit_fields(*this, inner);
            if (copies != nullptr) copies[i] = inner;
        }
    }
    template <class Body> void body(const Body*& given) {
        Body inner = *given;
        Body* const copy = take(given, 1);
        visit_fields(*this, inner);
        if (copy != nullptr) *copy = inner;
    }

private:
    unsigned char* memory_;
    std::size_t used_ = 0;
};

std::size_t copy_message(const plr_message& message, unsigned char* memory) {
    Copier copier(memory);
    const plr_message* whole = &message;
    plr_message inner = message;
    plr_message* const copy = copier.take(whole, 1);
    copier.text("origin", inner.origin);
    visit_body(copier, inner);
    if (copy != nullptr) *copy = inner;
    return copier.used();
}

}  // namespace

LentMessage::LentMessage(const plr_message& message, const ZoneName& name) {
    const std::size_t doubles = (copy_message(message, nullptr) + 15) / 16 * 2;
    memory_ = std::make_unique<GuardedMemory>(doubles, name);
    copy_message(message, reinterpret_cast<unsigned char*>(memory_->data()));
}

const plr_message& LentMessage::message() const noexcept {
    return *reinterpret_cast<const plr_message*>(memory_->data());
}
void LentMessage::make_read_only() { memory_->make_read_only(); }
void LentMessage::take_back() { memory_->take_back(); }

}  // namespace pelorus::conformance
