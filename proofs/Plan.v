(* (i) 3 and 4: where a plan brings the ego, at most and at least. *)
Require Import Reals Lra Lia Psatz.
Require Import Contract Shipped Motion Reach Statement Ego.
Open Scope R_scope.

Section Plan.
Variables (k : contract) (s v : R -> R) (T E pl pm a sensed : R) (n : nat).
Hypothesis ok : valid k.
Hypothesis m : motion s v.
Hypothesis plan : plan_followed k v T E pl pm a n.

Let sw := switching k.
Let sp := shortest_period k.
Let d := departure k sensed pl pm a.

Lemma sw_sp : 0 <= sw /\ sw <= sp /\ sp <= period k.
Proof. unfold sw, sp. pose proof (switching_fits k ok). lra. Qed.

Lemma go_time : 0 <= INR n * period k.
Proof. apply Rmult_le_pos; [apply pos_INR | destruct ok; lra]. Qed.

(** * At most *)

Let r0 := start (sensed + speed_error k).
Let r1 := at_most r0 (Rmax pm a) sw.
Let r2 := at_most r1 a (sp - sw).
Let hi3 := match n with O => a | S _ => Rmax a (ego_go k) end.
Let r3 := at_most r2 hi3 sw.
Let r4 := at_most r3 (ego_go k) (INR n * period k).

Lemma at_most_zero r x : 0 <= speed r -> at_most r x 0 = r.
Proof.
  intros. destruct r as [p q]. unfold at_most. cbn in *. f_equal; [lra | rewrite Rmax_left; lra].
Qed.

Lemma rests_is : rests k d n = rest_of r4 (ego_braking k).
Proof.
  unfold r4, r3, hi3, rests, d. rewrite departure_is. cbn zeta. fold sw sp. fold r0. fold r1. fold r2.
  destruct n as [| n']; [| rewrite rest_is; reflexivity].
  simpl INR. rewrite Rmult_0_l, at_most_zero by apply at_most_speed_nonneg. reflexivity.
Qed.

(* From any moment on the ego would, if it braked, be at rest by the place that was verified. *)
Lemma plan_stops u :
  - ego_braking k <= a -> v T <= sensed + speed_error k -> T <= u <= E ->
  s u - s T + v u * v u / (ego_braking k + ego_braking k) <= rests k d n.
Proof.
  intros ab vT [lo hi]. rewrite rests_is. destruct sw_sp as (sw0 & swsp & spp). pose proof go_time as n0.
  assert (b0 : 0 < ego_braking k) by (destruct ok; lra).
  assert (g0 : 0 < ego_go k) by (destruct ok; lra).
  set (b := ego_braking k) in *.
  pose proof (forwards s v m u) as vu.
  assert (p0 : 0 <= speed r0) by apply Rmax_r.
  assert (p1 : 0 <= speed r1) by apply at_most_speed_nonneg.
  assert (p2 : 0 <= speed r2) by apply at_most_speed_nonneg.
  assert (p3 : 0 <= speed r3) by apply at_most_speed_nonneg.
  assert (h1 : - b <= Rmax pm a) by (apply Rle_trans with (2 := Rmax_r _ _); lra).
  assert (h3 : - b <= hi3) by (unfold hi3; destruct n; [lra | apply Rle_trans with (2 := Rmax_l _ _); lra]).
  assert (grow : forall r x t1 t2, 0 <= speed r -> - b <= x -> 0 <= t1 <= t2 ->
            rest_of (at_most r x t1) b <= rest_of (at_most r x t2) b)
    by (intros; apply at_most_rest_grows; lra).
  assert (zero : forall r x t, 0 <= speed r -> - b <= x -> 0 <= t -> rest_of r b <= rest_of (at_most r x t) b).
  { intros r x t ? ? ?. rewrite <- (at_most_zero r x) at 1 by assumption. apply grow; lra. }
  assert (d12 : rest_of r1 b <= rest_of r2 b) by (apply zero; lra).
  assert (d23 : rest_of r2 b <= rest_of r3 b) by (apply zero; lra).
  assert (d34 : rest_of r3 b <= rest_of r4 b) by (apply zero; lra).
  assert (v0 : v T <= speed r0) by (cbn; cases; lra).
  assert (s0 : s T - s T <= distance r0) by (cbn; lra).
  assert (one : forall u, T <= u <= E -> u <= T + sw ->
            s u - s T <= distance (at_most r0 (Rmax pm a) (u - T)) /\ v u <= speed (at_most r0 (Rmax pm a) (u - T))).
  { intros t ? ?. apply (at_most_holds s v (s T)); auto; [lra |]. apply (up1 _ _ _ _ _ _ _ _ plan); auto. }
  destruct (Rle_dec u (T + sw)) as [e1 | l1].
  { destruct (one u ltac:(lra) e1) as [x1 x2]. pose proof (rest_of_within s v (s T) b _ u b0 vu x1 x2) as x3.
    pose proof (grow r0 (Rmax pm a) (u - T) sw p0 h1 ltac:(lra)) as x4. fold r1 in x4. lra. }
  destruct (one (T + sw) ltac:(lra) ltac:(lra)) as [s1 v1]. replace (T + sw - T) with sw in s1, v1 by ring. fold r1 in s1, v1.
  assert (two : forall u, T + sw <= u <= E -> u <= T + sp ->
            s u - s T <= distance (at_most r1 a (u - (T + sw))) /\ v u <= speed (at_most r1 a (u - (T + sw)))).
  { intros t ? ?. apply (at_most_holds s v (s T)); auto; [lra |]. apply (up2 _ _ _ _ _ _ _ _ plan); auto. }
  destruct (Rle_dec u (T + sp)) as [e2 | l2].
  { destruct (two u ltac:(lra) e2) as [x1 x2]. pose proof (rest_of_within s v (s T) b _ u b0 vu x1 x2) as x3.
    pose proof (grow r1 a (u - (T + sw)) (sp - sw) p1 ab ltac:(lra)) as x4. fold r2 in x4. lra. }
  destruct (two (T + sp) ltac:(lra) ltac:(lra)) as [s2 v2].
  replace (T + sp - (T + sw)) with (sp - sw) in s2, v2 by ring. fold r2 in s2, v2.
  assert (three : forall u, T + sp <= u <= E -> u <= T + sp + sw ->
            s u - s T <= distance (at_most r2 hi3 (u - (T + sp))) /\ v u <= speed (at_most r2 hi3 (u - (T + sp)))).
  { intros t ? ?. apply (at_most_holds s v (s T)); auto; [lra |]. apply (up3 _ _ _ _ _ _ _ _ plan); auto. }
  destruct (Rle_dec u (T + sp + sw)) as [e3 | l3].
  { destruct (three u ltac:(lra) e3) as [x1 x2]. pose proof (rest_of_within s v (s T) b _ u b0 vu x1 x2) as x3.
    pose proof (grow r2 hi3 (u - (T + sp)) sw p2 h3 ltac:(lra)) as x4. fold r3 in x4. lra. }
  destruct (three (T + sp + sw) ltac:(lra) ltac:(lra)) as [s3 v3].
  replace (T + sp + sw - (T + sp)) with sw in s3, v3 by ring. fold r3 in s3, v3.
  assert (four : forall u, T + sp + sw <= u <= E -> u <= T + sp + sw + INR n * period k ->
            s u - s T <= distance (at_most r3 (ego_go k) (u - (T + sp + sw))) /\
            v u <= speed (at_most r3 (ego_go k) (u - (T + sp + sw)))).
  { intros t ? ?. apply (at_most_holds s v (s T)); auto; [lra |]. apply (up4 _ _ _ _ _ _ _ _ plan); auto. }
  destruct (Rle_dec u (T + sp + sw + INR n * period k)) as [e4 | l4].
  { destruct (four u ltac:(lra) e4) as [x1 x2]. pose proof (rest_of_within s v (s T) b _ u b0 vu x1 x2) as x3.
    pose proof (grow r3 (ego_go k) (u - (T + sp + sw)) (INR n * period k) p3 ltac:(lra) ltac:(lra)) as x4. fold r4 in x4. lra. }
  destruct (four (T + sp + sw + INR n * period k) ltac:(lra) ltac:(lra)) as [s4 v4].
  replace (T + sp + sw + INR n * period k - (T + sp + sw)) with (INR n * period k) in s4, v4 by ring. fold r4 in s4, v4.
  apply (rest_holds s v (s T) b r4 (T + sp + sw + INR n * period k) u); auto; [lra |].
  apply (up5 _ _ _ _ _ _ _ _ plan). unfold sp, sw in *. lra.
Qed.

(** * At least *)

Let q0 := start (sensed - speed_error k).
Let q1 := at_least q0 (Rmin pl a) (unheld k) sw.
Let q2 := at_least q1 a (unheld k) (sp - sw).
Let q3 := at_least q2 (Rmin a (ego_go k)) (unheld k) sw.

Lemma least_is : least d = q3.
Proof. unfold d. rewrite departure_is. cbn zeta. reflexivity. Qed.

(* One speed can become the other in a time, for all that the ego can do: it grows at most at a_max, and not beyond the speed
   from which on the ego may be held. *)
Definition grows (x y time : R) := y <= x + ego_acceleration k * time /\ y <= Rmax (unheld k) x.

Lemma grows_on x y z p q : 0 <= p -> 0 <= q -> grows x y p -> grows y z q -> grows x z (p + q).
Proof.
  intros p0 q0' [a1 b1] [a2 b2]. split; [lra |]. apply Rle_trans with (1 := b2). apply Rmax_lub; [apply Rmax_l | exact b1].
Qed.

Lemma grows_step r x vu time rest_time :
  0 <= speed r -> 0 <= time -> 0 <= rest_time -> x <= ego_acceleration k -> 0 <= vu ->
  Rmin (speed r + x * time) (Rmax (unheld k) (speed r)) <= vu ->
  grows vu (speed (at_least r x (unheld k) (time + rest_time))) rest_time.
Proof.
  intros rr0 t0 rt0 xa vu0 low. unfold grows. cbn.
  assert (a0 : 0 < ego_acceleration k) by (destruct ok; lra).
  assert (x * rest_time <= ego_acceleration k * rest_time) by (apply Rmult_le_compat_r; lra).
  assert (0 <= ego_acceleration k * rest_time) by (apply Rmult_le_pos; lra).
  replace (x * (time + rest_time)) with (x * time + x * rest_time) by ring.
  destruct (Rle_dec 0 x).
  - assert (0 <= x * time) by nra. assert (0 <= x * rest_time) by nra. revert low. split; revert low; cases; lra.
  - assert (x * time <= 0) by nra. assert (x * rest_time <= 0) by nra. split; revert low; cases; lra.
Qed.

(* By the clearing time the ego has gone the target, and is at least as fast as computed. Whenever it is somewhere on the
   way, it can become no faster than that in the time that is left. *)
Lemma plan_clears target :
  sensed - speed_error k <= v T ->
  pl <= ego_acceleration k -> a <= ego_acceleration k ->
  in_time k d n target ->
  let clears := fst (clearing k (least d) target) in
  let V := snd (clearing k (least d) target) in
  0 <= clears /\ 0 <= V /\
  (T + clears <= E -> target <= s (T + clears) - s T) /\
  forall u, T <= u <= E -> u <= T + clears -> grows (v u) V (T + clears - u).
Proof.
  intros vT pla aa it. cbn zeta. revert it. unfold in_time. rewrite least_is, clearing_is. cbn [fst snd].
  fold sp sw. rewrite unlimited_is.
  destruct sw_sp as (sw0 & swsp & spp). pose proof go_time as n0.
  assert (gg : ego_go k <= ego_acceleration k) by (destruct ok; lra).
  assert (g0 : 0 < ego_go k) by (destruct ok; lra).
  pose proof (forwards s v m) as pos.
  assert (p0 : 0 <= speed q0) by apply Rmax_r.
  assert (p1 : 0 <= speed q1) by apply at_least_speed_nonneg.
  assert (p2 : 0 <= speed q2) by apply at_least_speed_nonneg.
  assert (p3 : 0 <= speed q3) by apply at_least_speed_nonneg.
  destruct (until_is q3 target (ego_go k) (unheld k) g0 ltac:(pose proof (unheld_enough k ok); lra) p3) as (ramp & steady & U & ra0 & st0 & V1 & V2 & W & V3).
  rewrite U. set (V := snd (until q3 target (ego_go k) (unheld k))) in *.
  set (C := Rmax (unheld k) (speed q3)) in *.
  intros it.
  assert (V0 : 0 <= V) by (rewrite V1; assert (0 <= ego_go k * ramp) by nra; lra).
  split; [lra |]. split; [exact V0 |].
  assert (v0 : speed q0 <= v T) by (cbn; pose proof (pos T); cases; lra).
  assert (s0 : distance q0 <= s T - s T) by (cbn; lra).
  assert (D1 : forall u, T <= u <= E -> u <= T + sw -> speeds_up_at_least v (Rmin pl a) (unheld k) T u)
    by (intros; apply (down1 _ _ _ _ _ _ _ _ plan); auto).
  assert (D2 : forall u, T + sw <= u <= E -> u <= T + sp -> speeds_up_at_least v a (unheld k) (T + sw) u)
    by (intros; apply (down2 _ _ _ _ _ _ _ _ plan); auto).
  assert (D3 : forall u, T + sp <= u <= E -> u <= T + sp + sw -> u <= T + (ramp + steady + sp + sw) ->
            speeds_up_at_least v (Rmin a (ego_go k)) (unheld k) (T + sp) u)
    by (intros; apply (down3 _ _ _ _ _ _ _ _ plan); auto; fold sp sw; lra).
  assert (D4 : forall u, T + sp + sw <= u <= E -> u <= T + (ramp + steady + sp + sw) ->
            speeds_up_at_least v (ego_go k) (unheld k) (T + sp + sw) u)
    by (intros; apply (down4 _ _ _ _ _ _ _ _ plan); auto; fold sp sw; lra).
  (* The bounds at the ends of the intervals. *)
  assert (one : T + sw <= E -> distance q1 <= s (T + sw) - s T /\ speed q1 <= v (T + sw)).
  { intros. pose proof (at_least_holds s v (s T) (Rmin pl a) (unheld k) q0 T (T + sw) m ltac:(lra)
      (D1 (T + sw) ltac:(lra) ltac:(lra)) p0 s0 v0) as HH. replace (T + sw - T) with sw in HH by ring. exact HH. }
  assert (two : T + sp <= E -> distance q2 <= s (T + sp) - s T /\ speed q2 <= v (T + sp)).
  { intros. destruct (one ltac:(lra)). pose proof (at_least_holds s v (s T) a (unheld k) q1 (T + sw) (T + sp) m ltac:(lra)
      (D2 (T + sp) ltac:(lra) ltac:(lra)) p1) as HH.
    replace (T + sp - (T + sw)) with (sp - sw) in HH by ring. apply HH; assumption. }
  assert (three : T + sp + sw <= E -> distance q3 <= s (T + sp + sw) - s T /\ speed q3 <= v (T + sp + sw)).
  { intros. destruct (two ltac:(lra)). pose proof (at_least_holds s v (s T) (Rmin a (ego_go k)) (unheld k) q2 (T + sp)
      (T + sp + sw) m ltac:(lra) (D3 (T + sp + sw) ltac:(lra) ltac:(lra) ltac:(lra)) p2) as HH.
    replace (T + sp + sw - (T + sp)) with sw in HH by ring. apply HH; assumption. }
  assert (low4 : forall u, T + sp + sw <= u <= E -> u <= T + (ramp + steady + sp + sw) ->
            Rmin (speed q3 + ego_go k * (u - (T + sp + sw))) C <= v u).
  { intros u [? ?] ?. destruct (three ltac:(lra)) as [_ v3].
    pose proof (D4 u ltac:(lra) ltac:(lra) (T + sp + sw) u ltac:(lra) ltac:(lra) ltac:(lra)) as HH.
    apply Rle_trans with (2 := HH). apply Rmin_glb.
    - apply Rle_trans with (1 := Rmin_l _ _). lra.
    - apply Rle_trans with (1 := Rmin_r _ _). apply Rle_max_compat_l. lra. }
  split.
  - (* It has gone the target. *)
    intros hE. destruct (three ltac:(lra)) as [s3 v3].
    set (t3 := T + sp + sw) in *.
    replace (T + (ramp + steady + sp + sw)) with (t3 + ramp + steady) in * by (unfold t3; ring).
    assert (A : (speed q3 + V) * ramp * (1 / 2) <= s (t3 + ramp) - s t3).
    { pose proof (above_line s v (speed q3) (ego_go k) t3 (t3 + ramp) m ltac:(lra)) as HH.
      replace ((speed q3 + V) * ramp * (1 / 2))
        with (speed q3 * (t3 + ramp - t3) + ego_go k * (t3 + ramp - t3) * (t3 + ramp - t3) / 2)
        by (rewrite V1; field).
      apply HH. intros t [? ?]. apply Rle_trans with (2 := low4 t ltac:(lra) ltac:(lra)).
      apply Rmin_glb; [lra |]. assert (ego_go k * (t - t3) <= ego_go k * ramp) by (apply Rmult_le_compat_l; lra). lra. }
    assert (B : C * steady <= s (t3 + ramp + steady) - s (t3 + ramp)).
    { destruct (Req_dec steady 0) as [z | nz].
      - rewrite z. replace (t3 + ramp + 0) with (t3 + ramp) by ring. lra.
      - pose proof (above_line s v C 0 (t3 + ramp) (t3 + ramp + steady) m ltac:(lra)) as HH.
        replace (C * steady) with (C * (t3 + ramp + steady - (t3 + ramp)) +
          0 * (t3 + ramp + steady - (t3 + ramp)) * (t3 + ramp + steady - (t3 + ramp)) / 2) by field.
        apply HH. intros t [? ?]. apply Rle_trans with (2 := low4 t ltac:(lra) ltac:(lra)).
        specialize (V3 ltac:(lra)).
        assert (ego_go k * ramp <= ego_go k * (t - t3)) by (apply Rmult_le_compat_l; lra).
        apply Rmin_glb; lra. }
    pose proof (Rmax_l (target - distance q3) 0). lra.
  - (* Nor is it slow on the way. *)
    intros u [lo hi] le.
    assert (G4 : forall u, T + sp + sw <= u <= E -> u <= T + (ramp + steady + sp + sw) ->
              grows (v u) V (T + (ramp + steady + sp + sw) - u)).
    { intros t ? ?. pose proof (low4 t ltac:(lra) ltac:(lra)) as L4. pose proof (pos t).
      assert (0 <= ego_acceleration k * (T + (ramp + steady + sp + sw) - t)) by (apply Rmult_le_pos; lra).
      set (x := t - (T + sp + sw)) in *.
      assert (lv : speed q3 + ego_go k * x <= V \/ V <= speed q3 + ego_go k * x) by lra.
      assert (ego_go k * (ramp - x) <= ego_acceleration k * (T + (ramp + steady + sp + sw) - t)).
      { destruct (Rle_dec 0 (ramp - x)).
        - apply Rle_trans with (ego_acceleration k * (ramp - x)); [apply Rmult_le_compat_r; lra |].
          apply Rmult_le_compat_l; unfold x; lra.
        - assert (0 <= ego_go k * (x - ramp)) by (apply Rmult_le_pos; lra). lra. }
      unfold grows. split.
      - revert L4. cases; lra.
      - assert (speed q3 <= v t).
        { assert (0 <= ego_go k * x) by (apply Rmult_le_pos; unfold x; lra).
          assert (speed q3 <= C) by apply Rmax_r. revert L4. cases; lra. }
        apply Rle_trans with (1 := V2). apply Rle_max_compat_l. lra. }
    assert (chain : grows (speed q3) V (ramp + steady)).
    { unfold grows. split.
      - rewrite V1. apply Rplus_le_compat_l. apply Rle_trans with (ego_acceleration k * ramp);
          [apply Rmult_le_compat_r; lra | apply Rmult_le_compat_l; lra].
      - exact V2. }
    destruct (Rle_dec (T + sp + sw) u) as [e4 | l4]; [apply G4; lra |].
    assert (step : forall r x t1 t2, 0 <= speed r -> x <= ego_acceleration k -> t1 <= u <= t2 ->
              speed r <= v t1 -> speeds_up_at_least v x (unheld k) t1 u ->
              grows (v u) (speed (at_least r x (unheld k) (t2 - t1))) (t2 - u)).
    { intros r x t1 t2 rr0 xa [? ?] vr low.
      replace (t2 - t1) with ((u - t1) + (t2 - u)) by ring. apply grows_step; try lra; [apply pos |].
      apply Rle_trans with (2 := low t1 u ltac:(lra) ltac:(lra) ltac:(lra)).
      apply Rmin_glb.
      - apply Rle_trans with (1 := Rmin_l _ _). lra.
      - apply Rle_trans with (1 := Rmin_r _ _). apply Rle_max_compat_l. lra. }
    assert (c3 : grows (speed q2) (speed q3) sw).
    { unfold q3. rewrite <- (Rplus_0_l sw) at 1.
      apply grows_step; try lra; [apply Rle_trans with (1 := Rmin_l _ _); lra |].
      apply Rle_trans with (1 := Rmin_l _ _). lra. }
    assert (c2 : grows (speed q1) (speed q2) (sp - sw)).
    { unfold q2. rewrite <- (Rplus_0_l (sp - sw)) at 1.
      apply grows_step; try lra. apply Rle_trans with (1 := Rmin_l _ _). lra. }
    assert (m3 : Rmin a (ego_go k) <= ego_acceleration k) by (apply Rle_trans with (1 := Rmin_l _ _); lra).
    assert (m1 : Rmin pl a <= ego_acceleration k) by (apply Rle_trans with (1 := Rmin_r _ _); lra).
    destruct (Rle_dec (T + sp) u) as [e3 | l3].
    { destruct (two ltac:(lra)) as [_ v2].
      pose proof (step q2 (Rmin a (ego_go k)) (T + sp) (T + sp + sw) p2 m3 ltac:(lra) v2 (D3 u ltac:(lra) ltac:(lra) ltac:(lra))) as g.
      replace (T + sp + sw - (T + sp)) with sw in g by ring. fold q3 in g.
      replace (T + (ramp + steady + sp + sw) - u) with ((T + sp + sw - u) + (ramp + steady)) by ring.
      apply grows_on with (speed q3); auto; lra. }
    destruct (Rle_dec (T + sw) u) as [e2 | l2].
    { destruct (one ltac:(lra)) as [_ v1].
      pose proof (step q1 a (T + sw) (T + sp) p1 aa ltac:(lra) v1 (D2 u ltac:(lra) ltac:(lra))) as g.
      replace (T + sp - (T + sw)) with (sp - sw) in g by ring. fold q2 in g.
      replace (T + (ramp + steady + sp + sw) - u) with ((T + sp - u) + (sw + (ramp + steady))) by ring.
      apply grows_on with (speed q2); auto; try lra. apply grows_on with (speed q3); auto; lra. }
    pose proof (step q0 (Rmin pl a) T (T + sw) p0 m1 ltac:(lra) v0 (D1 u ltac:(lra) ltac:(lra))) as g.
    replace (T + sw - T) with sw in g by ring. fold q1 in g.
    replace (T + (ramp + steady + sp + sw) - u) with ((T + sw - u) + ((sp - sw) + (sw + (ramp + steady)))) by ring.
    apply grows_on with (speed q1); auto; try lra. apply grows_on with (speed q2); auto; try lra.
    apply grows_on with (speed q3); auto; lra.
Qed.
End Plan.
