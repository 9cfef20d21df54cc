#include <gtest/gtest.h>

#include "pdoik/augmented_lagrangian.hpp"

namespace pdoik {
namespace {

TEST(Penalty, its_slope_is_the_derivative_of_its_value) {
  for (const PenaltyForm form : {PenaltyForm::Smooth, PenaltyForm::Printed}) {
    for (const double rho : {0.5, 1.0, 100.0}) {
      const Penalty penalty{form, rho};
      for (const double mu : {0.0, 0.7, 20.0}) {
        for (const double c : {-50.0, -1.0, -0.01, -1e-4, 1e-4, 0.01, 1.0, 50.0}) {
          const double kink = form == PenaltyForm::Smooth ? -mu / rho : 0.0, h = 1e-6;
          if (std::abs(c - kink) < 2.0 * h) continue;
          const double difference =
              (penalty.term(c + h, mu).value - penalty.term(c - h, mu).value) / (2.0 * h);
          EXPECT_NEAR(penalty.term(c, mu).slope, difference, 1e-6 * (1.0 + std::abs(difference)));
        }
      }
    }
  }
}

TEST(Penalty, both_forms_differ_by_a_constant_where_the_constraint_is_violated) {
  for (const double rho : {0.5, 10.0}) {
    const Penalty printed{PenaltyForm::Printed, rho}, smooth{PenaltyForm::Smooth, rho};
    for (const double mu : {0.0, 0.3, 4.0}) {
      for (const double c : {1e-9, 0.1, 3.0}) {
        EXPECT_NEAR(smooth.term(c, mu).value - printed.term(c, mu).value, mu * mu / (2.0 * rho),
                    1e-12);
        EXPECT_EQ(smooth.term(c, mu).slope, printed.term(c, mu).slope);
        EXPECT_EQ(smooth.updated_multiplier(c, mu), printed.updated_multiplier(c, mu));
      }
    }
  }
}

TEST(Penalty, acts_as_far_as_its_reach_and_no_farther) {
  for (const double mu : {0.0, 0.3, 4.0}) {
    const Penalty printed{PenaltyForm::Printed, 10.0}, smooth{PenaltyForm::Smooth, 10.0};
    EXPECT_EQ(printed.reach(mu), 0.0);
    EXPECT_EQ(printed.term(-1e-12, mu).slope, 0.0);
    EXPECT_EQ(smooth.term(-smooth.reach(mu) - 1e-12, mu).slope, 0.0);
    EXPECT_EQ(smooth.term(-smooth.reach(mu) - 1e-12, mu).value, 0.0);
    EXPECT_GT(smooth.term(0.01 - 0.99 * smooth.reach(mu), mu).slope, 0.0);
    EXPECT_NEAR(smooth.term(-smooth.reach(mu) + 1e-9, mu).slope, 0.0, 1e-7);  // no kink
  }
}

TEST(Penalty, multipliers_are_never_negative) {
  for (const PenaltyForm form : {PenaltyForm::Smooth, PenaltyForm::Printed}) {
    const Penalty penalty{form, 7.0};
    for (const double c : {-10.0, -1.0, -1e-9, 0.0, 1e-9, 1.0}) {
      for (const double mu : {0.0, 1e-9, 2.0}) {
        const double updated = penalty.updated_multiplier(c, mu);
        EXPECT_GE(updated, 0.0);
        EXPECT_TRUE(c <= 0.0 || updated > mu);
        EXPECT_TRUE(form == PenaltyForm::Smooth || updated >= mu);
      }
    }
  }
}

}  // namespace
}  // namespace pdoik
