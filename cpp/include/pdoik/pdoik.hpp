#pragma once

/// @namespace pdoik
/// Constrained inverse kinematics among point clouds. Metres, radians and seconds throughout; poses
/// name both frames, T_base_tip takes tip points to base. This header includes all others but
/// option_fields.hpp, by which bindings walk the options.

#include "pdoik/abi.hpp"
#include "pdoik/attachment.hpp"
#include "pdoik/augmented_lagrangian.hpp"
#include "pdoik/cloud.hpp"
#include "pdoik/collision_pairs.hpp"
#include "pdoik/contact_rule.hpp"
#include "pdoik/distance_field.hpp"
#include "pdoik/errors.hpp"
#include "pdoik/floating_base.hpp"
#include "pdoik/goal.hpp"
#include "pdoik/interior_spheres.hpp"
#include "pdoik/joint_limit_map.hpp"
#include "pdoik/lagrangian.hpp"
#include "pdoik/latency_histogram.hpp"
#include "pdoik/lbfgs.hpp"
#include "pdoik/levenberg_marquardt.hpp"
#include "pdoik/occupancy.hpp"
#include "pdoik/options.hpp"
#include "pdoik/path.hpp"
#include "pdoik/point_cloud.hpp"
#include "pdoik/request.hpp"
#include "pdoik/result.hpp"
#include "pdoik/robot.hpp"
#include "pdoik/shape.hpp"
#include "pdoik/shapes.hpp"
#include "pdoik/shrink_wrap.hpp"
#include "pdoik/simd.hpp"
#include "pdoik/solver.hpp"
#include "pdoik/timing.hpp"
#include "pdoik/tracker.hpp"
