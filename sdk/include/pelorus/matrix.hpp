/// Matrices of the author layer (Eigen, fixed size) and how they meet the ABI's views.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include <Eigen/Core>
#include <pelorus/abi/view.h>
#include <pelorus/failure.hpp>

namespace pelorus {

template <int Rows, int Cols = Rows> using Matrix = Eigen::Matrix<double, Rows, Cols>;
template <int Rows> using Vector = Eigen::Matrix<double, Rows, 1>;

/// What arguments hold that a model has said it does not read: whoever reads them all the same finds no answer accepted.
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Packed views of memory that somebody else owns.
inline plr_const_view const_view(const double* data, std::int64_t rows, std::int64_t cols,
                                 std::int64_t count) noexcept {
    return {data, rows, cols, count, 1, rows, rows * cols};
}
inline plr_view view(double* data, std::int64_t rows, std::int64_t cols, std::int64_t count) noexcept {
    return {data, rows, cols, count, 1, rows, rows * cols};
}
/// One matrix that is common to `count` items.
inline plr_const_view common_view(const double* data, std::int64_t rows, std::int64_t cols,
                                  std::int64_t count) noexcept {
    return {data, rows, cols, count, 1, rows, 0};
}
/// One Eigen object as a view of one item.
template <class Derived> plr_const_view const_view(const Eigen::PlainObjectBase<Derived>& matrix) noexcept {
    return const_view(matrix.data(), matrix.rows(), matrix.cols(), 1);
}
template <class Derived> plr_view view(Eigen::PlainObjectBase<Derived>& matrix) noexcept {
    return view(matrix.data(), matrix.rows(), matrix.cols(), 1);
}
inline plr_const_view as_const(const plr_view& v) noexcept {
    return {v.data, v.rows, v.cols, v.count, v.row_stride, v.col_stride, v.item_stride};
}
inline plr_const_view absent_view() noexcept { return {nullptr, 0, 0, 0, 0, 0, 0}; }
inline plr_view absent_output() noexcept { return {nullptr, 0, 0, 0, 0, 0, 0}; }

/// Items first .. first + count - 1 of a view.
template <class View> View slice(View whole, std::int64_t first, std::int64_t count) noexcept {
    if (whole.data != nullptr) whole.data += first * whole.item_stride;
    whole.count = count;
    return whole;
}

/// Reads item i into a fixed-size matrix, whatever the strides.
template <int Rows, int Cols> Matrix<Rows, Cols> load(const plr_const_view& from, std::int64_t i) noexcept {
    Matrix<Rows, Cols> out;
    const double* base = from.data + i * from.item_stride;
    if (from.row_stride == 1 && from.col_stride == Rows) {
        for (int k = 0; k < Rows * Cols; ++k) out.data()[k] = base[k];
    } else {
        for (int c = 0; c < Cols; ++c)
            for (int r = 0; r < Rows; ++r) out(r, c) = base[c * from.col_stride + r * from.row_stride];
    }
    return out;
}

/// Reads column c of item i.
template <int Rows> Vector<Rows> load_column(const plr_const_view& from, std::int64_t i, std::int64_t c) noexcept {
    Vector<Rows> out;
    const double* base = from.data + i * from.item_stride + c * from.col_stride;
    for (int r = 0; r < Rows; ++r) out(r) = base[r * from.row_stride];
    return out;
}

/// Writes a fixed-size matrix to item i (first column `c`), whatever the strides. Throws NumericError if it is not finite.
template <int Rows, int Cols>
void store(const plr_view& to, std::int64_t i, const Matrix<Rows, Cols>& value, std::int64_t c = 0) {
    double* base = to.data + i * to.item_stride + c * to.col_stride;
    double check = 0;  // stays 0 unless an element is infinite or not a number
    for (int k = 0; k < Rows * Cols; ++k) check += value.data()[k] * 0.0;
    if (!(check == 0.0)) throw NumericError("a result is not finite");
    if (to.row_stride == 1 && to.col_stride == Rows) {
        for (int k = 0; k < Rows * Cols; ++k) base[k] = value.data()[k];
    } else {
        for (int col = 0; col < Cols; ++col)
            for (int r = 0; r < Rows; ++r) base[col * to.col_stride + r * to.row_stride] = value(r, col);
    }
}

namespace detail {

[[noreturn]] inline void shape_error(const char* what, std::int64_t rows, std::int64_t cols, std::int64_t count,
                                     std::int64_t want_rows, std::int64_t want_cols, std::int64_t want_count) {
    const auto text = [](std::int64_t r, std::int64_t c, std::int64_t n) {
        return std::to_string(r) + " x " + std::to_string(c) + " x " + std::to_string(n);
    };
    throw ArgumentError(std::string(what) + ": is " + text(rows, cols, count) + ", expected " +
                        text(want_rows, want_cols, want_count));
}

}  // namespace detail

/// Throws ArgumentError unless the view has this shape; an input may be one matrix common to all items.
inline void expect(const plr_const_view& v, std::int64_t rows, std::int64_t cols, std::int64_t count,
                   const char* what) {
    const bool common = v.item_stride == 0 && v.count >= 1;
    if ((v.data == nullptr && rows * cols * count != 0) || v.rows != rows || v.cols != cols ||
        (v.count != count && !common))
        detail::shape_error(what, v.rows, v.cols, v.count, rows, cols, count);
}
inline void expect(const plr_view& v, std::int64_t rows, std::int64_t cols, std::int64_t count, const char* what) {
    if ((v.data == nullptr && rows * cols * count != 0) || v.rows != rows || v.cols != cols || v.count != count)
        detail::shape_error(what, v.rows, v.cols, v.count, rows, cols, count);
}

}  // namespace pelorus
