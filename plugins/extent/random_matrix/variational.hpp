/// extent.random_matrix, update `variational`: kinematics, shape and the points without noise by turns. See README.md.
#pragma once

#include "joint_matrix.hpp"

namespace random_matrix {

/// Orguner 2012. With A = E[(lambda X)^-1] the points without noise are N(H x + G (y - H x), G R), G = (R A + I)^-1: their
/// sums follow from the scatter, and no sweep walks through the points.
template <int D> class Variational : public Joint<Variational<D>, D, max_block * D> {
public:
    using Base = Joint<Variational<D>, D, max_block * D>;
    using typename Base::Block;
    using typename Base::Item;
    using typename Base::Shape;
    using typename Base::Spread;
    static constexpr int sweeps = 6;

    void setup(const pelorus::Setup& setup) {
        this->take_parts(setup);
        if (this->nominal_extent) throw pelorus::ParameterError("nominal_extent", "is for update: koch or lan_li only");
    }

    int spread_size() const { return this->block() * D; }

    Spread spread_of(const plr_const_view& covariance, std::int64_t i) const {
        const int c = spread_size();
        const double* const from = covariance.data + i * covariance.item_stride;
        Spread out(c, c);
        for (int col = 0; col < c; ++col)
            for (int row = 0; row < c; ++row) out(row, col) = from[col * covariance.col_stride + row];
        pelorus::small::symmetrise(out);
        return out;
    }

    Spread differenced(const Shape& shape, double dt, double number, const Matrix<D>& noise) const {
        const int b = this->block();
        const Matrix<D> centroid = (this->lambda * shape.extent() + noise) / number;
        Spread out = Spread::Zero(b * D, b * D);
        for (int k = 2; k < b; ++k)
            for (int axis = 0; axis < D; ++axis) out(k * D + axis, k * D + axis) = this->prior_variance(k);
        for (int col = 0; col < std::min(b, 2); ++col)
            for (int row = 0; row < std::min(b, 2); ++row) {
                const double factor = row + col == 0 ? 1.0 : row + col == 1 ? 1.0 / dt : 2.0 / (dt * dt);
                out.template block<D, D>(row * D, col * D) = factor * centroid;
            }
        return out;
    }

    /// (F1 (x) I) P (F1 (x) I)' + Q1 (x) I, block by block.
    Spread moved(const Spread& spread, const Block& transition, const Block& noise) const {
        const int b = this->block(), c = b * D;
        Spread left = Spread::Zero(c, c), out = Spread::Zero(c, c);
        for (int r = 0; r < b; ++r)
            for (int k = 0; k < b; ++k) left.middleRows(r * D, D) += transition(r, k) * spread.middleRows(k * D, D);
        for (int r = 0; r < b; ++r)
            for (int k = 0; k < b; ++k) out.middleCols(r * D, D) += transition(r, k) * left.middleCols(k * D, D);
        for (int r = 0; r < b; ++r)
            for (int k = 0; k < b; ++k)
                for (int axis = 0; axis < D; ++axis) out(r * D + axis, k * D + axis) += noise(r, k);
        pelorus::small::symmetrise(out);
        return out;
    }

    void correct(Item& item, const Scatter<D>& scatter, Told<D>& told) const {
        const Item predicted = item;
        const Matrix<D> position = this->position_covariance(item);
        const Matrix<D> point = this->lambda * item.shape.extent() + scatter.noise;
        told.innovation = scatter.centroid - item.state.col(0);
        told.covariance = position + point / scatter.number;
        told.log_likelihood = log_normal(told.innovation, told.covariance) + log_spread<D>(scatter, point);
        for (int sweep = 0; sweep < sweeps; ++sweep) {
            const Points points = clean_points(item, scatter);
            // The kinematics by the centroid of the clean points, its noise (n A)^-1.
            correct_kinematics(item, predicted, points.centroid, points.spread / scatter.number);
            const Vector<D> offset = points.centroid - item.state.col(0);
            item.shape.degrees = predicted.shape.degrees + scatter.number;
            item.shape.scale =
                predicted.shape.scale +
                (points.scatter + scatter.number * (offset * offset.transpose() + this->position_covariance(item) +
                                                    points.uncertainty)) /
                    this->lambda;
            pelorus::small::symmetrise(item.shape.scale);
        }
    }

    double covariance(const Item& item, const Matrix<D>&, int row, int col) const { return item.spread(row, col); }

private:
    struct Points {
        Vector<D> centroid;     ///< of the clean points, m
        Matrix<D> scatter;      ///< undivided, about their centroid, m^2
        Matrix<D> uncertainty;  ///< covariance of each, m^2
        Matrix<D> spread;       ///< A^-1: of a clean point about the centre, m^2
    };
    /// With E[X^-1] = (v - d - 1) V^-1.
    Points clean_points(const Item& item, const Scatter<D>& scatter) const {
        Points out;
        out.spread = this->lambda / (item.shape.degrees - D - 1) * item.shape.scale;
        // G = (R A + I)^-1 = A^-1 (R + A^-1)^-1, G R = A^-1 - A^-1 (R + A^-1)^-1 A^-1.
        const Matrix<D> whole = out.spread + scatter.noise;
        Matrix<D> root, solved = out.spread, gain;
        if (!pelorus::small::cholesky(whole, root)) throw not_definite();
        pelorus::small::cholesky_solve(root, solved);
        gain = solved.transpose();
        const Vector<D> centre = item.state.col(0);
        out.centroid = centre + gain * (scatter.centroid - centre);
        pelorus::small::symmetric_product(gain, scatter.sum, out.scatter);
        out.uncertainty = gain * scatter.noise;
        pelorus::small::symmetrise(out.uncertainty);
        return out;
    }

    /// x and P of the prediction, corrected by a position of that noise.
    void correct_kinematics(Item& item, const Item& predicted, const Vector<D>& position,
                            const Matrix<D>& noise) const {
        const int c = spread_size();
        using Tall = pelorus::small::Bounded<max_block * D, D>;
        using Wide = pelorus::small::Bounded<D, max_block * D>;
        const Matrix<D> s = predicted.spread.template topLeftCorner<D, D>() + noise;
        Matrix<D> root, noise_root;
        if (!pelorus::small::cholesky(s, root) || !pelorus::small::cholesky_semidefinite(noise, noise_root))
            throw not_definite();
        Wide weighted = predicted.spread.topRows(D);
        pelorus::small::cholesky_solve(root, weighted);
        const Tall gain = weighted.transpose();
        const Vector<D> innovation = position - predicted.state.col(0);
        const pelorus::small::Bounded<max_block * D, 1> step = gain.lazyProduct(innovation);
        for (int k = 0; k < c; ++k) item.state.data()[k] = predicted.state.data()[k] + step(k);
        // Joseph's form: (I - K H) P (I - K H)' + K N K'.
        Spread rest = Spread::Identity(c, c), out(c, c);
        rest.leftCols(D) -= gain;
        pelorus::small::symmetric_product(rest, predicted.spread, out);
        Tall share(c, D);
        pelorus::small::multiply(gain, noise_root, share);
        pelorus::small::add_gram(share, out);
        item.spread = out;
    }
};

}  // namespace random_matrix
