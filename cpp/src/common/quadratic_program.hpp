#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

namespace pdoik::detail {

/// Inequalities of a quadratic program: rows(i) x <= most[i] for i < count, and a box about x.
struct Inequalities {
  const Eigen::MatrixXd& rows;  ///< by columns, shape (n, at least count): row i is its column i
  const Eigen::VectorXd& most;  ///< shape (at least count,)
  int count;
  const Eigen::VectorXd &lower, &upper;  ///< shape (n,)
};

/// Small strictly convex quadratic programs, min 1/2 x'Hx + g'x under inequalities, by the dual
/// method of Goldfarb and Idnani (Mathematical Programming 27, 1983): it begins at the minimum
/// without any and takes in the most violated one after another. All memory is taken at
/// construction.
class QuadraticProgram {
 public:
  explicit QuadraticProgram(Eigen::Index variables);

  /// @param H  Shape (n, n); the upper triangle counts.
  /// @returns Whether it is positive definite.
  bool factorise(const Eigen::MatrixXd& H);
  /// With the H that was factorised last.
  /// @param x  Shape (n,), filled.
  /// @returns Whether all inequalities hold at x, to rounding. If not, x is of no use.
  bool solve(const Eigen::VectorXd& g, const Inequalities& within, Eigen::VectorXd& x);
  /// Whether an inequality held x back in the last solve.
  bool held() const { return active_ > 0; }

 private:
  /// How much the worst one is violated at x_; which it is: a row, or n for each side of the box.
  double worst(const Inequalities& within, int& which) const;
  /// Its gradient in y, where the Hessian is the identity, into normal_.
  void set_normal(const Inequalities& within, int which);
  /// What of normal_ lies along each of the first columns of the basis, and what is left of it.
  void split(int count);
  /// Make what was split an active normal.
  void add();
  /// Take the worst one in, and out what then pulls the wrong way.
  bool take_in(int which, double violation);
  void drop(int at);

  Eigen::LLT<Eigen::MatrixXd, Eigen::Upper> factor_;
  /// Of the active ones, by columns; an orthonormal basis of them, and each of them by it.
  Eigen::MatrixXd normals_, basis_, factor_of_normals_;
  Eigen::VectorXd x_, y_, normal_, kept_, direction_, along_, change_, pull_;
  std::vector<int> which_;
  int active_ = 0;
};

}  // namespace pdoik::detail
