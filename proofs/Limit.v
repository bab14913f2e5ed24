(* D11: near the speed limit go is reduced. *)
Require Import Reals Lra Psatz.
Require Import Contract Shipped Motion Reach.
Open Scope R_scope.

Lemma quotient_below x y d : 0 < d -> x <= y / d -> x * d <= y.
Proof. intros d0 le. apply (Rmult_le_compat_r d) in le; [| lra]. replace (y / d * d) with y in le by (field; lra). exact le. Qed.

(* L28: whenever a command takes effect, the ego gets no faster than its limit, or than it is with what is in effect
   already. *)
Lemma keeps_limit k v sensed previous bound command late time left left_then limit :
  valid k -> 0 <= v -> 0 <= late <= left -> left <= switching k -> late <= time -> 0 <= left_then <= switching k ->
  time + left_then <= period k + switching k ->
  v <= sensed + speed_error k -> previous <= bound -> ego_max_speed k <= limit ->
  v + Rmax 0 previous * left <= limit -> command <= most_command k sensed bound ->
  let then_ := Rmax 0 (v + previous * late) in
  let end_ := Rmax 0 (then_ + command * (time - late)) in
  end_ + Rmax 0 command * left_then <= limit.
Proof.
  intros ok v0 [l0 l1] l2 l3 [l4 l5] tl se pb ml vl cm. cbn zeta. destruct ok. unfold most_command in cm.
  assert (sw : 0 <= switching k) by (unfold switching; lra).
  set (room := ego_max_speed k - sensed - speed_error k) in *.
  set (P := Rmax 0 bound). assert (P0 : 0 <= P) by apply Rmax_l.
  set (p := Rmax 0 previous) in *. assert (p0 : 0 <= p) by apply Rmax_l.
  assert (pP : p <= P) by (unfold p, P; apply Rle_max_compat_l; lra).
  assert (pp : previous <= p) by apply Rmax_r.
  set (M := Rmin ((room - P * switching k) / period k) (room / (period k + switching k))) in *.
  assert (C : command <= Rmax 0 M) by (apply Rle_trans with (1 := cm); apply Rmin_l).
  assert (pl : 0 <= p * late) by (apply Rmult_le_pos; lra).
  assert (vlimit : v + p * late <= limit).
  { assert (p * late <= p * left) by (apply Rmult_le_compat_l; lra). lra. }
  assert (vlate : v + previous * late <= v + p * late).
  { assert (previous * late <= p * late) by (apply Rmult_le_compat_r; lra). lra. }
  set (V := Rmax 0 (v + previous * late)).
  assert (Vv : 0 <= V /\ V <= v + p * late) by (unfold V; cases; lra).
  destruct (Rle_dec command 0) as [brakes | goes].
  - rewrite (Rmax_left 0 command) by lra.
    assert (command * (time - late) <= 0) by nra. rewrite Rmult_0_l, Rplus_0_r. cases; lra.
  - rewrite (Rmax_right 0 command) by lra.
    assert (cM : command <= M) by (revert C; cases; lra).
    assert (c1 : command * period k <= room - P * switching k).
    { apply quotient_below; [lra |]. apply Rle_trans with (1 := cM). apply Rmin_l. }
    assert (c2 : command * (period k + switching k) <= room).
    { apply quotient_below; [lra |]. apply Rle_trans with (1 := cM). apply Rmin_r. }
    assert (0 <= command * (time - late)) by (apply Rmult_le_pos; lra).
    rewrite Rmax_right by lra.
    assert (command * (time - late) + command * left_then <= command * (period k + switching k - late)).
    { rewrite <- Rmult_plus_distr_l. apply Rmult_le_compat_l; lra. }
    assert (p * late <= P * late) by (apply Rmult_le_compat_r; lra).
    assert (P * late <= P * switching k) by (apply Rmult_le_compat_l; lra).
    (* Between a command that takes effect at once and one that takes effect late, the end is a mean. *)
    assert (P * late + command * (period k + switching k - late) <= room).
    { destruct (Rle_dec P command).
      - assert (P * late <= command * late) by (apply Rmult_le_compat_r; lra). lra.
      - assert (command * (switching k - late) <= P * (switching k - late)) by (apply Rmult_le_compat_r; lra). lra. }
    unfold room in *. lra.
Qed.

(* Why [unheld] is lower by what the ego loses by braking until its command takes effect: were it not, an ego that brakes when
   go is commanded could be below it when the reduced go takes effect, and accelerate less than go, though it is slow. *)
Lemma braking_first_matters : exists k sensed,
  valid k /\ most_command k sensed (- ego_braking k) < ego_go k /\
  sensed - ego_braking k * latency k < unheld k + ego_braking k * switching k.
Proof.
  pose (k := {| period := 1; latency := 1; jitter := 0; position_error := 0; speed_error := 0; slack := 1 / 100;
    ego_max_speed := 15; ego_acceleration := 3; ego_go := 3; ego_braking := 3;
    other_max_speed := 15; other_acceleration := 3; other_braking := 8;
    follower_reaction := 1 / 2; follower_braking := 4; precedence_braking := 3 |}).
  exists k, (21 / 2). split; [| split].
  - constructor; unfold k, hardest, unheld, switching; cbn; try lra. rewrite Rmax_right; lra.
  - unfold most_command, switching, k. cbn.
    apply Rle_lt_trans with (1 := Rmin_l _ _). apply Rmax_lub_lt; [lra |].
    apply Rle_lt_trans with (1 := Rmin_r _ _). lra.
  - unfold unheld, switching, k. cbn. lra.
Qed.
