#pragma once

/// Everything: constrained inverse kinematics among point clouds.

#include "pdoik/abi.hpp"
#include "pdoik/augmented_lagrangian.hpp"
#include "pdoik/cloud.hpp"
#include "pdoik/collision_pairs.hpp"
#include "pdoik/errors.hpp"
#include "pdoik/floating_base.hpp"
#include "pdoik/goal.hpp"
#include "pdoik/joint_limit_map.hpp"
#include "pdoik/lagrangian.hpp"
#include "pdoik/latency_histogram.hpp"
#include "pdoik/lbfgs.hpp"
#include "pdoik/levenberg_marquardt.hpp"
#include "pdoik/occupancy.hpp"
#include "pdoik/options.hpp"
#include "pdoik/point_cloud.hpp"
#include "pdoik/result.hpp"
#include "pdoik/robot.hpp"
#include "pdoik/simd.hpp"
#include "pdoik/solver.hpp"
#include "pdoik/tracker.hpp"
