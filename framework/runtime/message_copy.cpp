#include "runtime/message_copy.hpp"

#include <new>

#include "runtime/message_fields.hpp"

namespace pelorus::runtime {
namespace {

/// Lays a message out behind `base`. With base NULL it only measures. Both passes take the same steps.
class Packer {
public:
    explicit Packer(unsigned char* base) : base_(base) {}
    std::size_t used() const noexcept { return used_; }

    template <class Body> const Body* body(const Body* given) {
        Body packed = known_part(given);
        Body* place = reserve<Body>(1);
        visit_fields(*this, packed);
        if (place) *place = packed;
        return place;
    }

    template <class Number> void value(Number&) {}
    void count(const char*, std::int64_t&) {}

    void text(const char*, const char*& given) { given = copy(given, std::strlen(given) + 1); }
    void text_or_null(const char* field, const char*& given) {
        if (given) text(field, given);
    }
    void texts(const char* field, const char* const*& given, std::uint32_t n) {
        if (!given) return;
        const char** place = reserve<const char*>(n);
        for (std::uint32_t i = 0; i < n; ++i) {
            const char* one = given[i];
            text(field, one);
            if (place) place[i] = one;
        }
        given = place;
    }

    template <class Number> void array(const char*, const Number*& given, std::int64_t n, unsigned) {
        given = given && n > 0 ? copy(given, static_cast<std::size_t>(n)) : nullptr;
    }
    std::int64_t offsets(const char*, const std::int64_t*& given, std::int64_t n, unsigned) {
        const std::int64_t last = given && n > 0 ? given[n] : 0;
        given = given && n > 0 ? copy(given, static_cast<std::size_t>(n) + 1) : nullptr;
        return last;
    }

    void view(const char*, plr_const_view& given, std::int64_t rows, std::int64_t cols, std::int64_t n,
              unsigned flags) {
        const plr_const_view from = given;
        if (rows == any_size) rows = from.rows;
        if (cols == any_size) cols = from.cols;
        given = plr_const_view{nullptr, rows, cols, n, 1, rows, rows * cols};
        if (!from.data || n == 0 || rows * cols == 0) {
            if (flags & field_optional) given = plr_const_view{};
            return;
        }
        const bool common = from.item_stride == 0 && (flags & field_common);
        const std::int64_t items = common ? 1 : n;
        if (common) given.item_stride = 0;
        double* place = reserve<double>(static_cast<std::size_t>(rows * cols * items));
        given.data = place;
        if (place) gather(from, items, place);
    }

    std::int64_t space(const char* field, const plr_space*& given, unsigned) {
        if (!given) return 0;
        plr_space packed = known_part(given);
        plr_space* place = reserve<plr_space>(1);
        elements(field, packed.components, packed.size);
        if (place) *place = packed;
        given = place;
        return packed.size;
    }

    template <class Struct> void elements(const char*, const Struct*& first, std::uint32_t n) {
        Struct* place = n ? reserve<Struct>(n) : nullptr;
        for (std::uint32_t i = 0; i < n; ++i) {
            Struct element = known_element(first, i);
            visit_fields(*this, element);
            if (place) place[i] = element;
        }
        first = place;
    }

private:
    template <class T> T* reserve(std::size_t n) {
        constexpr std::size_t alignment = alignof(T) < 8 ? alignof(T) : 16;
        used_ = (used_ + alignment - 1) / alignment * alignment;
        T* place = base_ ? reinterpret_cast<T*>(base_ + used_) : nullptr;
        std::size_t bytes = 0;
        if (__builtin_mul_overflow(n, sizeof(T), &bytes) || __builtin_add_overflow(used_, bytes, &used_))
            throw std::bad_alloc();
        return place;
    }
    template <class T> const T* copy(const T* from, std::size_t n) {
        T* place = reserve<T>(n);
        if (place) std::memcpy(place, from, n * sizeof(T));
        return place;
    }
    static void gather(const plr_const_view& from, std::int64_t items, double* to) {
        const bool packed = from.row_stride == 1 && (from.cols == 1 || from.col_stride == from.rows) &&
                            (items == 1 || from.item_stride == from.rows * from.cols);
        if (packed) {
            std::memcpy(to, from.data, static_cast<std::size_t>(from.rows * from.cols * items) * sizeof(double));
            return;
        }
        for (std::int64_t i = 0; i < items; ++i)
            for (std::int64_t col = 0; col < from.cols; ++col)
                for (std::int64_t row = 0; row < from.rows; ++row)
                    *to++ = from.data[i * from.item_stride + col * from.col_stride + row * from.row_stride];
    }

    unsigned char* base_;
    std::size_t used_ = 0;
};

void pack_body(Packer& packer, plr_message& message) {
    switch (message.kind) {
        case PLR_MESSAGE_SCAN:
            message.body.scan = packer.body(message.body.scan);
            break;
        case PLR_MESSAGE_TRACKS:
            message.body.tracks = packer.body(message.body.tracks);
            break;
        case PLR_MESSAGE_TRUTH:
            message.body.truth = packer.body(message.body.truth);
            break;
        case PLR_MESSAGE_VALUES:
            message.body.values = packer.body(message.body.values);
            break;
        case PLR_MESSAGE_TABLE:
            message.body.table = packer.body(message.body.table);
            break;
        default:
            break;  // check_message lets no other pass
    }
}

}  // namespace

MessageRef copy_message(MessagePool& pool, const plr_message& message) {
    plr_message measured = known_part(&message);
    Packer ruler(nullptr);
    pack_body(ruler, measured);

    MessageBlock* block = pool.acquire(ruler.used());
    MessageRef result(block);
    block->message = known_part(&message);
    block->message.origin = nullptr;
    block->message.edge = 0;
    Packer packer(block->payload());
    pack_body(packer, block->message);
    return result;
}

}  // namespace pelorus::runtime
