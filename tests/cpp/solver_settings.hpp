#pragma once

#include <gtest/gtest.h>

#include "arms.hpp"

/// The ways to solve, and when two answers are the same.
namespace pdoik::testing {

struct Setting {
  const char* name;
  Method method;
  InnerMethod inner;
};
inline const Setting kSettings[] = {{"default", Method::Default, InnerMethod::LevenbergMarquardt},
                                    {"default with L-BFGS", Method::Default, InnerMethod::Lbfgs},
                                    {"paper", Method::Paper, InnerMethod::Lbfgs}};

template <class Check>
void for_settings(Check&& check) {
  for (const Setting& setting : kSettings) {
    SCOPED_TRACE(setting.name);
    check(timeless(GoalType::Pose, setting.method, setting.inner));
    if (::testing::Test::HasFailure()) return;
  }
}

inline void expect_same(const Result& a, const Result& b) {
  EXPECT_EQ(a.q, b.q);
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.success, b.success);
  EXPECT_EQ(a.position_error, b.position_error);
  EXPECT_EQ(a.rotation_error, b.rotation_error);
  EXPECT_EQ(a.clearance, b.clearance);
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.evaluations, b.evaluations);
  EXPECT_EQ(a.restarts, b.restarts);
  EXPECT_EQ(a.worst.kind, b.worst.kind);
  EXPECT_EQ(a.worst.index, b.worst.index);
}

}  // namespace pdoik::testing
