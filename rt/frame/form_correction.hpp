// Online correction of what full detail costs against coarse forms: one bounded ratio, learnt from whole frames.
#pragma once

namespace surefoot::rt {

/// A frame's time is modelled as other + f * full + c * coarse, with the predicted sums of both kinds of form. f and c follow
/// slowly, by a Kalman filter with two states. One common factor cannot follow both: where coarse forms take longer than
/// predicted, it makes full detail look too expensive, although it would fit. Source: Kalman 1960.
class FormCorrection {
public:
    static constexpr double max_ratio = 3;

    /// Predicted times, us, without this correction: full and coarse by their kind, other without items. Pairs that are not
    /// positive and finite are ignored.
    void update(double full_us, double coarse_us, double other_us, double actual_us);
    /// f / c, within 1 / max_ratio and max_ratio; 1 until frames say otherwise.
    [[nodiscard]] double ratio() const;

private:
    double full_ = 1, coarse_ = 1;
    double var_full_ = 0.25, var_coarse_ = 0.25, covariance_ = 0.225;  ///< both are likely to be wrong alike
};

}  // namespace surefoot::rt
