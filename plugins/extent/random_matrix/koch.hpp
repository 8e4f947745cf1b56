/// extent.random_matrix, updates `koch` and `lan_li`: the covariance of the kinematics is P1 (x) X. See README.md.
#pragma once

#include "joint_matrix.hpp"

namespace random_matrix {

/// A point is N(centre, B X B'), with B = sqrt(lambda) I (Koch 2008) or Y^1/2 X^-1/2, Y = lambda X + R (Lan, Li 2012).
template <int D> class Koch : public Joint<Koch<D>, D, max_block> {
public:
    using Base = Joint<Koch<D>, D, max_block>;
    using typename Base::Block;
    using typename Base::Item;
    using typename Base::Shape;
    using typename Base::Spread;

    void setup(const pelorus::Setup& setup) {
        this->take_parts(setup);
        nominal_ = this->nominal_extent.value_or(50.0);
    }

    int spread_size() const { return this->block(); }

    /// P1 of a full covariance: mean of each block's diagonal, over the nominal extent.
    Spread spread_of(const plr_const_view& covariance, std::int64_t i) const {
        const int b = this->block();
        const double* const from = covariance.data + i * covariance.item_stride;
        Spread out = Spread::Zero(b, b);
        for (int col = 0; col < b; ++col)
            for (int row = 0; row < b; ++row)
                for (int axis = 0; axis < D; ++axis)
                    out(row, col) += from[(col * D + axis) * covariance.col_stride + row * D + axis] / (D * nominal_);
        return out;
    }

    /// P1 of two centroids of covariance s X/n each; higher derivatives by their prior deviation.
    Spread differenced(const Shape& shape, double dt, double number, const Matrix<D>& noise) const {
        const int b = this->block();
        Spread out = Spread::Zero(b, b);
        for (int k = 2; k < b; ++k) out(k, k) = this->prior_variance(k) / nominal_;
        out(0, 0) = spread_of_points(shape.extent(), noise).volume / number;
        if (b < 2) return out;
        out(0, 1) = out(1, 0) = out(0, 0) / dt;
        out(1, 1) = 2.0 * out(0, 0) / (dt * dt);
        return out;
    }

    Spread moved(const Spread& spread, const Block& transition, const Block& noise) const {
        Spread out(this->block(), this->block());
        pelorus::small::symmetric_product(transition, spread, out);
        return out + noise / nominal_;
    }

    void correct(Item& item, const Scatter<D>& scatter, Told<D>& told) const {
        const Matrix<D> extent = item.shape.extent();
        const PointSpread points = spread_of_points(extent, scatter.noise);
        const double noise = points.volume / scatter.number, scale = item.spread(0, 0) + noise;
        told.innovation = scatter.centroid - item.state.col(0);
        told.covariance = extent * scale;
        told.log_likelihood = log_normal(told.innovation, told.covariance) + log_spread<D>(scatter, points.covariance);
        correct_kinematics(item, told.innovation, scale, noise);
        item.shape.degrees += scatter.number;
        pelorus::small::add_outer(1.0 / scale, told.innovation, item.shape.scale);
        Matrix<D> share;
        pelorus::small::symmetric_product(points.inverse_factor, scatter.sum, share);
        item.shape.scale += share;
    }

    double covariance(const Item& item, const Matrix<D>& extent, int row, int col) const {
        return item.spread(row / D, col / D) * extent(row % D, col % D);
    }

private:
    /// Of one point about the centre: B X B', B^-1, |det B|^(2/d).
    struct PointSpread {
        Matrix<D> covariance, inverse_factor;
        double volume;
    };
    PointSpread spread_of_points(const Matrix<D>& extent, const Matrix<D>& noise) const {
        if (this->rule == Rule::koch)
            return {this->lambda * extent, Matrix<D>::Identity() / std::sqrt(this->lambda), this->lambda};
        PointSpread out;
        out.covariance = this->lambda * extent + noise;
        Matrix<D> root, inverse, factor_x, factor_y;
        if (!pelorus::small::square_root(extent, root) ||
            !pelorus::small::inverse_square_root(out.covariance, inverse) ||
            !pelorus::small::cholesky(extent, factor_x) || !pelorus::small::cholesky(out.covariance, factor_y))
            throw not_definite();
        pelorus::small::multiply(root, inverse, out.inverse_factor);
        // det B = sqrt(det Y / det X).
        out.volume =
            std::exp((pelorus::small::log_determinant(factor_y) - pelorus::small::log_determinant(factor_x)) / D);
        return out;
    }

    /// x += e K', P1 in Joseph's form, with K = P1[:, p]/s and H = [1 0 ..].
    void correct_kinematics(Item& item, const Vector<D>& innovation, double scale, double noise) const {
        using Gain = pelorus::small::Bounded<max_block, 1>;
        const int b = this->block();
        const Gain gain = item.spread.col(0) / scale;
        for (int k = 0; k < b; ++k) item.state.col(k) += gain(k) * innovation;
        Block rest = Block::Identity(b, b), spread(b, b);
        rest.col(0) -= gain;
        pelorus::small::symmetric_product(rest, item.spread, spread);
        pelorus::small::add_outer(noise, gain, spread);
        item.spread = spread;
    }

    double nominal_ = 50;
};

}  // namespace random_matrix
