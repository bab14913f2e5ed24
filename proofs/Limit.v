(* D11: near the speed limit go is reduced. *)
Require Import Reals Lra Psatz.
Require Import Contract Shipped Motion Reach.
Open Scope R_scope.

Lemma below_quotient x y d : 0 < d -> x * d <= y -> x <= y / d.
Proof. intros. apply Rmult_le_reg_r with d; [lra |]. field_simplify; lra. Qed.

Lemma quotient_below x y d : 0 < d -> x <= y / d -> x * d <= y.
Proof. intros d0 le. apply (Rmult_le_compat_r d) in le; [| lra]. replace (y / d * d) with y in le by (field; lra). exact le. Qed.

(* L31: an ego that is no faster than [unheld] when it is commanded may go. *)
Lemma may_go k v sensed in_effect :
  valid k -> v <= unheld k -> sensed <= v + speed_error k -> in_effect <= ego_acceleration k ->
  ego_go k <= most_command k sensed in_effect.
Proof.
  intros ok vu se ie. destruct ok. unfold most_command, unheld in *.
  assert (sw : 0 <= switching k) by (unfold switching; lra).
  assert (E : Rmax 0 in_effect <= ego_acceleration k) by (cases; lra).
  assert (Rmax 0 in_effect * switching k <= ego_acceleration k * switching k) by (apply Rmult_le_compat_r; lra).
  assert (ego_go k * switching k <= ego_acceleration k * switching k) by (apply Rmult_le_compat_r; lra).
  apply Rmin_glb; [| lra]. apply Rle_trans with (2 := Rmax_r _ _).
  apply Rmin_glb; apply below_quotient; lra.
Qed.

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

(* What L31 does not say: an ego that brakes when go is commanded, at a speed above [unheld], may be below [unheld] when the
   reduced go takes effect. Then it accelerates less than go, though it is slow. Theorem 1 assumes that it does not: [obeys]. *)
Lemma reduced_go_may_be_slow : exists k sensed,
  valid k /\ most_command k sensed (- ego_braking k) < ego_go k /\ sensed - ego_braking k * latency k < unheld k.
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

Lemma at_least_lower_cap v a cap cap' t1 t2 :
  cap' <= cap -> speeds_up_at_least v a cap t1 t2 -> speeds_up_at_least v a cap' t1 t2.
Proof.
  intros le up t t' ? ? ?. apply Rle_trans with (2 := up t t' ltac:(lra) ltac:(lra) ltac:(lra)).
  apply Rle_min_compat_l, Rle_max_compat_r, le.
Qed.

(* What would do: were the speed from which on the ego may be held lower by what it can lose by braking until a command takes
   effect, every ego with a limiter at [held] and go reduced by [most_command] would be as fast as [obeys] demands. *)
Lemma reduced_go_is_fast_enough k v tau previous sensed in_effect held t2 :
  valid k -> (forall t, 0 <= v t) -> - ego_braking k <= previous -> sensed <= v tau + speed_error k ->
  in_effect <= ego_acceleration k -> unheld k <= held ->
  let command := Rmin (ego_go k) (most_command k sensed in_effect) in
  speeds_up_at_least v (Rmin previous command) held tau (tau + latency k) ->
  speeds_up_at_least v command held (tau + latency k) t2 ->
  let cap := unheld k - ego_braking k * latency k in
  speeds_up_at_least v (Rmin previous (ego_go k)) cap tau (tau + latency k) /\
  speeds_up_at_least v (ego_go k) cap (tau + latency k) t2.
Proof.
  intros ok pos pb se ie hl. cbn zeta. intros up1 up2.
  assert (bl : 0 <= ego_braking k * latency k) by (destruct ok; apply Rmult_le_pos; lra).
  assert (lat : 0 <= latency k) by (destruct ok; lra).
  destruct (Rle_dec (ego_go k) (most_command k sensed in_effect)) as [full | reduced].
  { rewrite (Rmin_left (ego_go k)) in up1, up2 by lra. split; apply at_least_lower_cap with held; auto; lra. }
  rewrite (Rmin_right (ego_go k)) in up1, up2 by lra.
  set (c := most_command k sensed in_effect) in *.
  assert (c0 : 0 <= c).
  { unfold c, most_command. apply Rmin_glb; [apply Rmax_l | destruct ok; lra]. }
  assert (fast : unheld k < v tau).
  { destruct (Rlt_le_dec (unheld k) (v tau)) as [? | slow]; [assumption | exfalso].
    apply reduced. apply may_go with (v tau); auto. }
  (* Until the command takes effect it brakes at b at most. *)
  assert (first : forall t, tau <= t <= tau + latency k -> unheld k - ego_braking k * latency k <= v t).
  { intros t [? ?]. pose proof (up1 tau t ltac:(lra) ltac:(lra) ltac:(lra)) as U.
    assert (M : - ego_braking k * (t - tau) <= Rmin previous c * (t - tau)).
    { apply Rmult_le_compat_r; [lra | apply Rmin_glb; destruct ok; lra]. }
    assert (ego_braking k * (t - tau) <= ego_braking k * latency k) by (apply Rmult_le_compat_l; destruct ok; lra).
    apply Rle_trans with (2 := U). apply Rmin_glb; [lra |].
    apply Rle_trans with (2 := Rmax_r _ _). lra. }
  assert (second : forall t, tau + latency k <= t <= t2 -> unheld k - ego_braking k * latency k <= v t).
  { intros t [? ?]. pose proof (up2 (tau + latency k) t ltac:(lra) ltac:(lra) ltac:(lra)) as U.
    pose proof (first (tau + latency k) ltac:(lra)).
    assert (0 <= c * (t - (tau + latency k))) by (apply Rmult_le_pos; lra).
    apply Rle_trans with (2 := U). apply Rmin_glb; [lra |]. apply Rle_trans with (2 := Rmax_r _ _). lra. }
  split.
  - intros t t' ? ? ?. pose proof (up1 t t' ltac:(lra) ltac:(lra) ltac:(lra)) as U.
    pose proof (first t ltac:(lra)).
    rewrite (Rmax_right (unheld k - ego_braking k * latency k)) by lra.
    destruct (Rle_dec previous c) as [lower | higher].
    + rewrite (Rmin_left previous c) in U by lra. rewrite (Rmin_left previous (ego_go k)) by lra.
      apply Rle_trans with (2 := U). apply Rle_min_compat_l, Rmax_r.
    + rewrite (Rmin_right previous c) in U by lra. apply Rle_trans with (1 := Rmin_r _ _).
      assert (0 <= c * (t' - t)) by (apply Rmult_le_pos; lra).
      apply Rle_trans with (2 := U). apply Rmin_glb; [lra | apply Rmax_r].
  - intros t t' ? ? ?. pose proof (up2 t t' ltac:(lra) ltac:(lra) ltac:(lra)) as U.
    pose proof (second t ltac:(lra)).
    rewrite (Rmax_right (unheld k - ego_braking k * latency k)) by lra.
    apply Rle_trans with (1 := Rmin_r _ _).
    assert (0 <= c * (t' - t)) by (apply Rmult_le_pos; lra).
    apply Rle_trans with (2 := U). apply Rmin_glb; [lra | apply Rmax_r].
Qed.
