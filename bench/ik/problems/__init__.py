"""Scenes as users have them: public problem sets and our own of the same kinds, judged by meshes.

Problems come in from files (`loaders`) or are made (`families`), a method answers them within a
budget (`methods`), and coal says on the robot's published meshes and the true shapes whether an
answer touches anything (`judge`). `python -m bench.ik.problems --help` has the commands.
"""
