// The forward rollout for one instruction set: included by roll_out_*.cpp inside a function's body,
// with its arguments in scope.

for (int b = 1; b < count; ++b) {
  const RolloutJoint& joint = joints[b];
  const Frame parent = frames[joint.parent];
  const Vec4 x = rotate(parent, joint.fixed.x), y = rotate(parent, joint.fixed.y);
  const Vec4 z = rotate(parent, joint.fixed.z), p = transform(parent, joint.fixed.p);
  if (joint.prismatic) {
    frames[b] = {x, y, z, p + z * broadcast(joint.multiplier * q[joint.dof] + joint.offset)};
    continue;
  }
  double c, s;
  if (joint.plain) {
    c = cosine[joint.dof];
    s = sine[joint.dof];
  } else {
    const double angle = joint.multiplier * q[joint.dof] + joint.offset;
    c = __builtin_cos(angle);
    s = __builtin_sin(angle);
  }
  frames[b] = {x * broadcast(c) + y * broadcast(s), y * broadcast(c) - x * broadcast(s), z, p};
}
