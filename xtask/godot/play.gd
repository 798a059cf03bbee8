# Prints where bodies of GLB files are at times of their clips:
# godot --headless --path PROJECT --script play.gd -- FILE.glb TIME,TIME,… BODY,BODY,… …
extends SceneTree


# The first frame: only then are nodes in the tree.
func _process(_delta: float) -> bool:
	var arguments := OS.get_cmdline_user_args()
	for first in range(0, arguments.size(), 3):
		play(arguments[first], arguments[first + 1].split(","), arguments[first + 2].split(","))
	return true


func play(file: String, times: PackedStringArray, bodies: PackedStringArray) -> void:
	var scene: Node = load("res://" + file).instantiate()
	root.add_child(scene)
	var player: AnimationPlayer = scene.find_child("AnimationPlayer", true, false)
	player.play(player.get_animation_list()[0])
	for time in times:
		player.seek(float(time), true)
		for body in bodies:
			var node: Node3D = scene.find_child(body, true, false)
			var at := node.global_position
			var turn := node.global_basis.get_rotation_quaternion()
			var row := [at.x, at.y, at.z, turn.w, turn.x, turn.y, turn.z]
			print("pose,", file, ",", time, ",", body, ",", ",".join(row.map(func(number): return "%.9f" % number)))
	scene.free()
